#include "pcm/convert/open_cloud.h"

#include "pcm/io/pipe/limited_reader.h"
#include "pcm/io/pipe/selected_reader.h"
#include "pcm/system/error.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/tree_reader.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

fs::path folder_of_tree(const fs::path& path)
{
    if (path.filename() == index_file_name) return path.has_parent_path() ? path.parent_path() : fs::path(".");
    return path.filename().empty() ? path.parent_path() : path;
}

unsigned chunks_ahead(const ReadOptions& read) { return std::min(thread_count(read.threads), 8u); }

std::unique_ptr<PointReader> open_tree(const fs::path& path, const CloudOptions& options, const Selection& selection)
{
    const auto tree = Tree::open(path);
    std::optional<std::uint16_t> level = options.level;
    if (level && tree->info().levels && *level >= tree->info().levels)
        throw Error(ErrorCode::invalid_argument, path,
                    "level " + std::to_string(*level) + " was requested; this tree has levels 0 to " +
                        std::to_string(tree->info().levels - 1));
    if (options.max_points) level = tree->level_with_at_most(*options.max_points);
    auto reader = std::make_unique<TreeReader>(tree, level, selection, chunks_ahead(options.read));
    if (!options.read.largest_coordinate) return reader;
    return std::make_unique<LimitedReader>(std::move(reader), *options.read.largest_coordinate);
}

}  // namespace

CloudSources::CloudSources(const std::vector<fs::path>& inputs, const CloudOptions& options) : options_(options)
{
    for (const fs::path& input : inputs) {
        if (is_tree(input)) {
            paths_.push_back(folder_of_tree(input));
            is_tree_.push_back(true);
            continue;
        }
        if (options.level || options.max_points)
            throw Error(ErrorCode::invalid_argument, input,
                        "only point cloud trees have levels, and this is not a tree",
                        "build a tree of it first with 'pcmlab build'");
        for (fs::path& file : expand_inputs({input})) {
            paths_.push_back(std::move(file));
            is_tree_.push_back(false);
        }
    }
    if (paths_.empty()) throw Error(ErrorCode::invalid_argument, {}, "no input was given");
    if (options.level && options.max_points)
        throw Error(ErrorCode::invalid_argument, {},
                    "a level and a number of points were given; only one of them can choose the level");
    if (options.max_points && paths_.size() > 1)
        throw Error(ErrorCode::invalid_argument, {},
                    "a number of points chooses the level of a single tree; several inputs were given");
}

std::unique_ptr<PointReader> CloudSources::open() const
{
    const Selection& selection = options_.selection;
    if (paths_.size() == 1 && is_tree_[0]) return open_tree(paths_[0], options_, selection);
    Selection box;  // trees are read only where they touch the box and the region
    box.box = selection.box;
    box.region = selection.region;
    std::vector<MergedReader::Source> sources;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
        if (is_tree_[i])
            sources.push_back(
                {paths_[i], [path = paths_[i], options = options_, box] { return open_tree(path, options, box); }});
        else
            sources.push_back(
                {paths_[i], [path = paths_[i], read = options_.read] { return open_reader(path, read); }});
    }
    auto merged = std::make_unique<MergedReader>(std::move(sources));
    if (!selection.chooses_points() && !selection.chooses_attributes()) return merged;
    return std::make_unique<SelectedReader>(std::move(merged), selection);
}

std::vector<std::string> CloudSources::names() const
{
    std::vector<std::string> names;
    for (const fs::path& path : paths_) names.push_back(path.filename().string());
    return names;
}

}  // namespace pcm
