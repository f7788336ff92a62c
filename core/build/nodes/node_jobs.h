// The nodes of a whole cloud, built bin by bin on several threads.
#pragma once

#include "pcm/build/nodes/data_files.h"
#include "pcm/build/nodes/node_plan.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

// Bins, and the nodes above them, as jobs in post-order. Output is committed in that order, so the files do not depend
// on the threads. Few results wait for their turn, so memory stays bounded.
template <class Coord>
class NodeJobs {
public:
    // All arguments must outlive the jobs.
    NodeJobs(const TopTree<Coord>& top, const SortedBins<Coord>& bins, const LevelsOfBins& levels,
             const NodeBuilderOptions& options, DraftStore& drafts, DataFiles& files);

    // Before run(): takes over the jobs that an interrupted run had committed, from the records that save() wrote;
    // run() does the rest. Throws Error(corrupt | truncated | not_found) when the records do not match the data files.
    // After that this object and the data files must not be used.
    void resume(const std::vector<const std::vector<std::byte>*>& records);
    std::size_t restored() const { return restored_; }  // jobs that resume() took over
    std::size_t size() const { return jobs_.size(); }

    // Returns the root; null for a cloud without points. `progress(points done)` is called on this thread and may
    // throw. `committed(jobs)` is called after each job whose chunks were appended to the data files, on any thread but
    // one at a time: jobs 0 .. jobs - 1 are committed by then, and save() may be called for them.
    Draft* run(unsigned threads, const std::function<void(std::uint64_t)>& progress,
               const std::function<void(std::size_t)>& committed);

    // The record of the committed jobs first .. last - 1, all after those of the record before.
    void save(std::size_t first, std::size_t last, ByteWriter& out) const;

private:
    using Builder = NodeBuilder<Coord>;
    struct Job : NodeJob {
        bool claimed = false;
        bool done = false;
        typename Builder::Region region;
    };

    typename Builder::Region regained(Builder& builder, std::size_t job) const;
    struct Run;
    std::optional<std::size_t> next_job(Run& run, std::unique_lock<std::mutex>& lock) const;
    void work(Run& run);
    void take_inputs(Builder& builder, const Job& job, bool restored, typename Builder::Region& left,
                     typename Builder::Region& right);
    void load(std::size_t job, ByteReader& in);
    typename Builder::Region build(Builder& builder, Job& job, typename Builder::Region left,
                                   typename Builder::Region right, typename Builder::Output& output) const;

    const SortedBins<Coord>& bins_;
    const LevelsOfBins& levels_;
    const NodeBuilderOptions& options_;
    DraftStore& drafts_;
    DataFiles& files_;
    std::vector<Job> jobs_;
    std::size_t restored_ = 0;
};

extern template class NodeJobs<std::uint32_t>;
extern template class NodeJobs<std::uint64_t>;

}  // namespace pcm
