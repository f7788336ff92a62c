#include "pcm/filter/result_tree.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree_lock.h"

#include <algorithm>
#include <optional>
#include <system_error>

namespace pcm {

namespace fs = std::filesystem;

BuildReport build_result(const fs::path& path, const ResultOptions& options,
                         const std::function<std::shared_ptr<PointReader>(std::shared_ptr<const Tree>)>& filter)
{
    const bool in_place = options.target.in_place;
    if (in_place != options.target.copy.empty())
        throw Error(ErrorCode::invalid_argument, path,
                    in_place ? "both a new tree and a change in place were asked for"
                             : "neither a new tree nor a change in place was asked for",
                    "name a new tree, or change the tree in place");
    // In place, changes that others make meanwhile would be lost. Into another tree, the snapshot opened here is read.
    std::optional<TreeLock> held;
    if (in_place) held.emplace(Tree::open(path)->folder());
    const std::shared_ptr<const Tree> tree = Tree::open(path);
    std::error_code ignored;
    if (!in_place && fs::equivalent(tree->folder(), options.target.copy, ignored))
        throw Error(ErrorCode::invalid_argument, options.target.copy, "the output is the input tree",
                    "give the new tree another name, or change the tree in place");
    BuildOptions build;
    build.memory_bytes = options.memory_bytes < least_build_memory
                             ? options.memory_bytes
                             : std::max(least_build_memory, options.memory_bytes - options.reader_memory());
    build.threads = options.threads;
    build.chunk_points = options.chunk_points;
    build.sampling = options.sampling.value_or(tree->info().sampling);
    build.overwrite = in_place || options.overwrite;
    build.progress = options.progress;
    check_build_options(build);  // before the filter begins
    const std::shared_ptr<PointReader> points = filter(tree);
    return build_tree(*points, tree->info().sources, in_place ? tree->folder() : options.target.copy, build);
}

}  // namespace pcm
