#include "plugin/meshlab/io/import.h"

#include "pcm/io/file_text.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/points_layer.h"
#include "plugin/scene/misfit.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/text.h"
#include "plugin/scene/tree_beside.h"

#include <set>

namespace pcm::host {

namespace {

// Reports each kind of misfit once, as soon as enough is known of the cloud.
class MisfitCheck {
public:
    MisfitCheck(const MeshModel& layer, const OnMisfit& on_misfit) : layer_(layer), on_misfit_(on_misfit) {}

    void operator()(const std::vector<Metadata>& metadata, const std::optional<Box3d>& box)
    {
        std::vector<std::string> reasons;
        for (Misfit& misfit : misfits(layer_of(layer_), metadata, box))
            if (reported_.insert(misfit.kind).second) reasons.push_back(std::move(misfit.text));
        if (!reasons.empty()) on_misfit_(reasons);
    }

private:
    const MeshModel& layer_;
    const OnMisfit& on_misfit_;
    std::set<Misfit::Kind> reported_;
};

std::vector<std::string> open_tree(const std::filesystem::path& path, MeshModel& layer, MisfitCheck& check)
{
    const auto cloud = open_cloud(path);
    const TreeInfo& info = cloud->info();
    check(info.metadata, info.points ? std::optional<Box3d>(info.bounds()) : std::nullopt);
    return show_tree(layer, cloud);
}

bool is_specified(const TextLayout& layout)
{
    return layout.separator || layout.skip_lines || !layout.columns.empty() || layout.colour_range;
}

}  // namespace

std::vector<std::string> import_cloud(const std::filesystem::path& path, MeshModel& layer,
                                      const ImportSettings& settings, const ProgressFunction& progress,
                                      const OnMisfit& on_misfit)
{
    MisfitCheck check(layer, on_misfit);
    if (extension_of(path) == tree_extension || is_file_of_tree(path)) return open_tree(path, layer, check);

    ReadOptions options;
    options.threads = 0;
    options.text = settings.text;
    options.skip_bad_lines = settings.skip_bad_lines;
    options.largest_coordinate = settings.largest_coordinate;
    TreeBeside tree{path, tree_path(path, settings.tree_folder), options,
                    is_specified(settings.text) || settings.skip_bad_lines};
    const auto reader = open_reader(path, options);
    const FileInfo info = reader->info();
    check(info.metadata, info.promised_box);  // before a long build
    const bool surely_large = info.points_known && info.points > settings.largest_layer;
    if (!surely_large) {
        auto lines = load_points(layer, *reader, settings.largest_layer, progress,
                                 [&](const Box3d& box) { check(info.metadata, box); });
        if (lines) return *lines;
    }
    if (!settings.may_build_beside && settings.tree_folder.empty() &&
        !tree_is_current(tree.tree, path, info.points_known ? std::optional(info.points) : std::nullopt))
        throw Error(ErrorCode::invalid_argument, path,
                    "has " +
                        (info.points_known ? grouped(info.points) : "more than " + grouped(settings.largest_layer)) +
                        " points and is opened through a tree, whose folder is not given",
                    "give tree_folder, or a larger most_points_in_ordinary_layer to load all points into memory");
    std::vector<std::string> lines = ensure_tree(tree, info, progress);
    for (std::string& line : open_tree(tree.tree, layer, check)) lines.push_back(std::move(line));
    return lines;
}

}  // namespace pcm::host
