#include "pcm/update/compact.h"

#include "pcm/system/error.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/tree_lock.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/update/fitted_reader.h"

#include <algorithm>
#include <memory>
#include <optional>

namespace pcm {

namespace fs = std::filesystem;

CompactReport compact_tree(const fs::path& path, const CompactOptions& options)
{
    const bool in_place = options.output.empty();
    // In place, changes that others make meanwhile would be lost. Into another tree, the snapshot opened here is read.
    std::optional<TreeLock> held;
    if (in_place) held.emplace(Tree::open(path)->folder());
    const std::shared_ptr<const Tree> tree = Tree::open(path);
    const TreeInfo& info = tree->info();

    const unsigned threads = thread_count(options.threads);
    TreeReader points(tree, std::nullopt, {}, std::clamp(threads, 1u, 8u));
    FittedReader cloud(points, info, tree->folder());
    BuildOptions build;
    build.memory_bytes = options.memory_bytes;
    build.threads = options.threads;
    build.chunk_points = options.chunk_points;
    build.sampling = info.sampling;
    build.overwrite = in_place || options.overwrite;
    build.progress = options.progress;
    CompactReport report;
    for (const auto& entry : fs::directory_iterator(tree->folder()))
        if (entry.is_regular_file()) report.bytes_before += entry.file_size();
    report.build = rebuild_tree(cloud, info, in_place ? tree->folder() : options.output, build);
    return report;
}

}  // namespace pcm
