#include "pcm/convert/open_cloud.h"

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
    return std::make_unique<TreeReader>(tree, level, selection, chunks_ahead(options.read));
}

}  // namespace

CloudSources::CloudSources(const std::vector<fs::path>& inputs, const CloudOptions& options) : options_(options)
{
    Selection box;  // trees are read only where they touch the box and the region
    box.box = options.selection.box;
    box.region = options.selection.region;
    std::size_t trees = 0;
    for (const fs::path& input : inputs) {
        if (is_tree(input)) {
            const fs::path folder = folder_of_tree(input);
            inputs_.sources.push_back({folder, [folder, options, box] { return open_tree(folder, options, box); }});
            ++trees;
            continue;
        }
        if (options.level || options.max_points)
            throw Error(ErrorCode::invalid_argument, input,
                        "only point cloud trees have levels, and this is not a tree",
                        "build a tree of it first with 'pcmlab build'");
        inputs_.add(input, options.read);
    }
    inputs_.skip_bad_files = options.read.skip_bad_files;
    if (inputs.empty()) throw Error(ErrorCode::invalid_argument, {}, "no input was given");
    for (const MergedReader::Source& source : inputs_.sources) paths_.push_back(source.path);
    is_one_tree_ = trees == 1 && inputs.size() == 1;
    if (options.level && options.max_points)
        throw Error(ErrorCode::invalid_argument, {},
                    "a level and a number of points were given; only one of them can choose the level");
    if (options.max_points && paths_.size() > 1)
        throw Error(ErrorCode::invalid_argument, {},
                    "a number of points chooses the level of a single tree; several inputs were given");
}

std::unique_ptr<PointReader> CloudSources::open()
{
    const Selection& selection = options_.selection;
    names_.clear();
    if (is_one_tree_) {
        names_.push_back(paths_[0].filename().string());
        return open_tree(paths_[0], options_, selection);
    }
    auto merged = std::make_unique<MergedReader>(inputs_);
    for (const MergedReader::Source& source : merged->sources()) names_.push_back(source.path.filename().string());
    if (!selection.chooses_points() && !selection.chooses_attributes()) return merged;
    return std::make_unique<SelectedReader>(std::move(merged), selection);
}

}  // namespace pcm
