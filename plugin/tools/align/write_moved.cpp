#include "plugin/tools/align/write_moved.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/free_path.h"
#include "plugin/scene/moved_tree.h"
#include "plugin/scene/result_layer.h"
#include "plugin/tools/align/align_session.h"

#include <cmath>

namespace pcm::host {

namespace {

// MeshLab's kind of callback has no place for an object.
std::function<void(const QString&)>& listener()
{
    static auto* const listener = new std::function<void(const QString&)>;
    return *listener;
}

bool report(const int percent, const char*)
{
    if (listener()) listener()(QString("Writing the moved tree: %1 %. Esc cancels it.").arg(percent));
    return true;
}

std::filesystem::path with_extension(const QString& file)
{
    std::filesystem::path path = file.toStdString();
    if (path.extension() != ".pct") path += ".pct";
    return path;
}

LayerCloud tree_of(const AlignSession& session)
{
    const SceneLayer* layer = session.moving();
    const auto tree = layer ? layer->tree() : std::nullopt;
    if (!tree)
        throw Error(ErrorCode::invalid_argument, {}, "the moving layer is not a point cloud tree",
                    "build a tree of it, or use its matrix and export it");
    return *tree;
}

}  // namespace

QString proposed_tree(const AlignSession& session)
{
    return QString::fromStdString(free_path(tree_of(session).cloud->tree()->folder(), "-aligned.pct").string());
}

void write_moved_layer(AlignSession& session, const QString& file, const std::function<void(const QString&)>& say)
{
    if (!session.fit()) throw Error(ErrorCode::invalid_argument, {}, session.problem().toStdString());
    const Affine motion = session.fit()->motion;
    const LayerCloud tree = tree_of(session);
    const std::filesystem::path output = with_extension(file);
    Scene& scene = session.scene();
    const int layer_id = session.moving()->id();
    BuildReport written;
    {
        listener() = say;
        Operation operation(report);
        BuildOptions build;
        build.progress = operation.progress();
        try {
            written = write_moved_tree(tree.cloud->tree(), {motion}, output, build);
        } catch (...) {
            listener() = nullptr;
            throw;
        }
        listener() = nullptr;
    }
    for (const std::string& note : written.notes) scene.log(LogLevel::filter, note.c_str());
    scene.log(
        LogLevel::filter,
        QString::fromStdString("Wrote the moved tree " + output.string() + ": " + grouped(written.outcome.points_out) +
                               " points; largest position error " + exact(written.outcome.error) + " source units."));
    SceneLayer* const former = scene.layer(layer_id);
    const TreeResult result{output, former ? std::vector<SceneLayer*>{former} : std::vector<SceneLayer*>(), false};
    for (const std::string& line : show_result(scene, result)) scene.log(LogLevel::filter, line.c_str());
    say("The moved tree " + QString::fromStdString(output.filename().string()) +
        " is shown; the layer that it was made " + "from is hidden.");
}

}  // namespace pcm::host
