#include "plugin/meshlab/drawn_copy.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/layer_reader.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/proxy.h"
#include "plugin/scene/scene.h"
#include "plugin/scene/tree_cache.h"

namespace pcm::host {

namespace {

// The most that a build has on disk: its scratch file and the tree.
std::uint64_t bytes_needed(const FileInfo& info)
{
    std::uint64_t point = 3 * sizeof(double);
    for (const Attribute& attribute : info.schema) point += attribute.components * size_of(attribute.type);
    return 2 * point * info.points + (std::uint64_t(1) << 20);
}

}  // namespace

std::string why_not_drawn(const MeshModel& layer)
{
    const std::string name = "the layer '" + layer_of(layer).label().toStdString() + "'";
    const LayerCounts counts = counts_of(layer);
    if (counts.faces > 0 || counts.edges > 0) return name + " has faces or edges, not only points";
    if (counts.vertices == 0) return name + " has no points";
    return {};
}

void draw_as_cloud(MeshModel& layer, const ProgressFunction& progress)
{
    if (const std::string reason = why_not_drawn(layer); !reason.empty())
        throw Error(ErrorCode::invalid_argument, {}, reason);
    Registry& registry = Registry::instance();
    LayerReader vertices(layer, {});
    const auto cached = TreeCache::instance().reserve(bytes_needed(vertices.info()));
    BuildOptions options;
    options.memory_bytes = std::uint64_t(256) << 20;
    options.resume = false;
    if (progress)
        options.progress = [&](ProgressUpdate update) {
            update.stage = "Preparing the picture";
            return progress(update);
        };
    build_tree(vertices, {layer_of(layer).label().toStdString()}, cached->folder(), options);

    TreeLayer copy;
    copy.cloud = open_cloud(cached->folder());
    const auto source = registry.source_of(layer);
    copy.origin = source ? source->origin : layer_of(layer).scene().origin().value_or(Vec3d{0, 0, 0});
    copy.state = state_of(layer, Watched::vertices);
    copy.glance = state_of(layer, Watched::vertices, glance_vertices);
    copy.cached = cached;
    if (progress) progress({"The picture is ready", 1, -1});
    registry.attach_copy(layer, std::move(copy));
}

bool is_outdated(const MeshModel& layer, bool glance)
{
    const auto copy = Registry::instance().drawn(layer);
    if (!copy || !copy->is_copy()) return false;
    return glance ? copy->glance != state_of(layer, Watched::vertices, glance_vertices)
                  : copy->state != state_of(layer, Watched::vertices);
}

}  // namespace pcm::host
