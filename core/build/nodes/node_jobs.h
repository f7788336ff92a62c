// The nodes of a whole cloud, built bin by bin on several threads.
#pragma once

#include "pcm/build/checkpoints.h"
#include "pcm/build/nodes/data_files.h"
#include "pcm/build/levels/level_sampler.h"
#include "pcm/build/nodes/node_builder.h"
#include "pcm/build/levels/sorted_bins.h"
#include "pcm/build/bins/top_tree.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace pcm {

// Bins, and the nodes above them, as jobs in post-order. Output is committed in that order, so the files do not depend
// on which thread did what; and so few results are kept waiting that memory stays bounded.
template <class Coord>
class NodeJobs {
public:
    // All arguments must outlive the jobs.
    NodeJobs(const TopTree<Coord>& top, const SortedBins<Coord>& bins, const LevelSampler<Coord>& levels,
             const NodeBuilderOptions& options, DraftStore& drafts, DataFiles& files);

    // Before run(): what was committed until the checkpoints in `records` were made is taken from them, and run() does
    // the rest. Throws Error(corrupt | truncated | not_found) when they do not go together with the files; all is to be
    // made anew then.
    void go_on(const std::vector<const std::vector<std::byte>*>& records);
    std::size_t restored() const { return restored_; }
    std::size_t size() const { return jobs_.size(); }

    // Returns the root; null for a cloud without points. `progress(points done)` is called on this thread and may
    // throw.
    Draft* run(unsigned threads, Checkpoints& checkpoints, const std::function<void(std::uint64_t)>& progress);

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

    typename Builder::Region regained(Builder& builder, std::size_t job) const;
    void save(std::size_t first, std::size_t last, ByteWriter& out) const;
    void load(std::size_t job, ByteReader& in);
    void checkpoint(Checkpoints& checkpoints, std::size_t committed);
    std::optional<std::size_t> list(std::uint32_t node, const NodePath& path);
    std::uint64_t rows(std::uint32_t node) const;
    void plan();
    typename Builder::Region build(Builder& builder, Job& job, typename Builder::Region left,
                                   typename Builder::Region right, typename Builder::Output& output) const;

    const TopTree<Coord>& top_;
    const SortedBins<Coord>& bins_;
    const LevelSampler<Coord>& levels_;
    const NodeBuilderOptions& options_;
    DraftStore& drafts_;
    DataFiles& files_;
    std::vector<Job> jobs_;
    std::size_t restored_ = 0;      // jobs that go_on() has found done
    std::size_t checkpointed_ = 0;  // jobs that are in a checkpoint
    std::uint64_t bytes_checkpointed_ = 0;
};

extern template class NodeJobs<std::uint32_t>;
extern template class NodeJobs<std::uint64_t>;

}  // namespace pcm
