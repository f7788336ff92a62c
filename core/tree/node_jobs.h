// The nodes of a whole cloud, built bin by bin on several threads.
#pragma once

#include "tree/data_files.h"
#include "tree/level_sampler.h"
#include "tree/node_builder.h"
#include "tree/sorted_bins.h"
#include "tree/top_tree.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace pcm {

// Bins, and the nodes above them, as jobs in post-order. Output is committed in that order, so the files do not depend on
// which thread did what; and so few results are kept waiting that memory stays bounded.
template <class Coord>
class NodeJobs {
public:
    // All arguments must outlive the jobs.
    NodeJobs(const TopTree<Coord>& top, const SortedBins<Coord>& bins, const LevelSampler<Coord>& levels,
             const NodeBuilderOptions& options, DraftStore& drafts, DataFiles& files);

    // Returns the root; null for a cloud without points. `progress(points done)` is called on this thread and may throw.
    Draft* run(unsigned threads, const std::function<void(std::uint64_t)>& progress);

private:
    using Builder = NodeBuilder<Coord>;
    struct Job {
        NodePath path;
        std::optional<std::size_t> bin;
        std::array<std::size_t, 2> inputs{};  // job numbers, for a node above bins
        std::vector<std::uint64_t> histogram;
        std::vector<LevelRange> above;  // what the nodes above take
        LevelRange own;                 // what this node takes, when it is above bins
        bool claimed = false;
        bool done = false;
        typename Builder::Region region;
    };

    std::optional<std::size_t> list(std::uint32_t node, const NodePath& path);
    std::uint64_t rows(std::uint32_t node) const;
    void plan();
    typename Builder::Region build(Builder& builder, Job& job, typename Builder::Region left, typename Builder::Region right,
                                   typename Builder::Output& output) const;

    const TopTree<Coord>& top_;
    const SortedBins<Coord>& bins_;
    const LevelSampler<Coord>& levels_;
    const NodeBuilderOptions& options_;
    DraftStore& drafts_;
    DataFiles& files_;
    std::vector<Job> jobs_;
};

extern template class NodeJobs<std::uint32_t>;
extern template class NodeJobs<std::uint64_t>;

}  // namespace pcm
