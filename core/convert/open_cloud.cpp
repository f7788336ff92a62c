#include "pcm/convert/open_cloud.h"

#include "pcm/io/pipe/limited_reader.h"
#include "pcm/io/pipe/selected_reader.h"
#include "pcm/system/error.h"
#include "pcm/system/tree_folder.h"
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
    const fs::path folder = tree_folder_of(path);
    return folder.filename().empty() ? folder.parent_path() : folder;
}

unsigned chunks_ahead(const ReadOptions& read) { return std::min(thread_count(read.threads), 8u); }

std::unique_ptr<TreeReader> tree_reader(const fs::path& path, const CloudOptions& options, const Selection& selection)
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

std::unique_ptr<PointReader> open_tree(const fs::path& path, const CloudOptions& options, const Selection& selection)
{
    auto reader = tree_reader(path, options, selection);
    if (!options.read.largest_coordinate) return reader;
    return std::make_unique<LimitedReader>(std::move(reader), *options.read.largest_coordinate);
}

}  // namespace

CloudSources::CloudSources(const std::vector<fs::path>& inputs, const CloudOptions& options) : options_(options)
{
    for (const fs::path& input : inputs) {
        // A folder with the files of a tree but without its index is a damaged tree: opening it reports that.
        if (is_tree(input) || is_tree_folder(tree_folder_of(input))) {
            add_tree(input);
            continue;
        }
        if (options.level || options.max_points)
            throw Error(ErrorCode::invalid_argument, input,
                        "only point cloud trees have levels, and this is not a tree",
                        "build a tree of it first with 'pcmlab build'");
        inputs_.add(input, options.read);
    }
    inputs_.skip_bad_files = options.read.skip_bad_files;
    inputs_.ignore_crs = options.read.ignore_crs;
    if (inputs.empty()) throw Error(ErrorCode::invalid_argument, {}, "no input was given");
    for (const MergedReader::Source& source : inputs_.sources) paths_.push_back(source.path);
    if (options.level && options.max_points)
        throw Error(ErrorCode::invalid_argument, {},
                    "a level and a number of points were given; only one of them can choose the level");
    if (options.max_points && paths_.size() > 1)
        throw Error(ErrorCode::invalid_argument, {},
                    "a number of points chooses the level of a single tree; several inputs were given");
}

// The points of a tree are taken once, however many of its files are named.
void CloudSources::add_tree(const fs::path& input)
{
    const fs::path folder = folder_of_tree(input);
    if (is_file_of_tree(input) && input.filename() != index_file_name)
        notes_.push_back(input.string() + " is a file of the point cloud tree " + folder.string() +
                         ": the whole tree is read");
    for (const fs::path& tree : trees_)
        if (same_tree_folder(tree, folder)) {
            notes_.push_back("the tree " + folder.string() + " is named more than once; it is read once");
            return;
        }
    Selection box;  // trees are read only where they touch the box and the region
    box.box = options_.selection.box;
    box.region = options_.selection.region;
    inputs_.sources.push_back(
        {folder, [folder, options = options_, box] { return pcm::open_tree(folder, options, box); }});
    trees_.push_back(folder);
}

std::unique_ptr<PointReader> CloudSources::open()
{
    const Selection& selection = options_.selection;
    names_.clear();
    if (trees_.size() == 1 && paths_.size() == 1 && inputs_.left_out.empty()) {
        names_.push_back(paths_[0].filename().string());
        return pcm::open_tree(paths_[0], options_, selection);
    }
    auto merged = std::make_unique<MergedReader>(inputs_);
    for (const MergedReader::Source& source : merged->sources()) names_.push_back(source.path.filename().string());
    if (!selection.chooses_points() && !selection.chooses_attributes()) return merged;
    return std::make_unique<SelectedReader>(std::move(merged), selection, passed_);
}

std::unique_ptr<TreeReader> CloudSources::open_tree() const
{
    if (trees_.size() != 1 || paths_.size() != 1 || !inputs_.left_out.empty() || options_.read.largest_coordinate)
        return nullptr;
    return tree_reader(paths_[0], options_, options_.selection);
}

Box3d CloudSources::bounds() const
{
    Box3d box = *passed_;
    for (const fs::path& tree : trees_) box.extend(Tree::open(tree)->info().bounds());
    return box;
}

bool CloudSources::has(const fs::path& path) const
{
    std::error_code error;
    return std::any_of(paths_.begin(), paths_.end(),
                       [&](const fs::path& input) { return fs::equivalent(input, path, error); });
}

}  // namespace pcm
