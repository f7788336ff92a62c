#include "plugin/io/import.h"

#include "pcm/io/file_text.h"
#include "pcm/tree/tree.h"
#include "plugin/host/layer.h"
#include "plugin/host/points_layer.h"
#include "plugin/io/tree_beside.h"

namespace pcm::host {

namespace {

std::vector<std::string> open_tree(const std::filesystem::path& path, MeshModel& layer)
{
    return show_tree(layer, Registry::instance().open(path));
}

bool is_specified(const TextLayout& layout)
{
    return layout.separator || layout.skip_lines || !layout.columns.empty() || layout.colour_range;
}

}  // namespace

std::vector<std::string> import_cloud(const std::filesystem::path& path, MeshModel& layer,
                                      const ImportSettings& settings, const ProgressFunction& progress)
{
    if (extension_of(path) == tree_extension) return open_tree(path, layer);

    ReadOptions options;
    options.threads = 0;
    options.text = settings.text;
    options.largest_coordinate = settings.largest_coordinate;
    TreeBeside tree{path, tree_path(path, settings.tree_folder), options, is_specified(settings.text)};
    const auto reader = open_reader(path, options);
    const FileInfo info = reader->info();
    const bool surely_large = info.points_known && info.points > settings.largest_layer;
    if (!surely_large) {
        auto lines = load_points(layer, *reader, settings.largest_layer, progress);
        if (lines) return *lines;
    }
    std::vector<std::string> lines = ensure_tree(tree, info, progress);
    for (std::string& line : open_tree(tree.tree, layer)) lines.push_back(std::move(line));
    return lines;
}

}  // namespace pcm::host
