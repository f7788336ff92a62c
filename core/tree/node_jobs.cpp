#include "tree/node_jobs.h"

#include "tree/crew.h"

#include <map>

namespace pcm {

template <class Coord>
NodeJobs<Coord>::NodeJobs(const TopTree<Coord>& top, const SortedBins<Coord>& bins, const LevelSampler<Coord>& levels,
                          const NodeBuilderOptions& options, DraftStore& drafts, DataFiles& files)
    : top_(top), bins_(bins), levels_(levels), options_(options), drafts_(drafts), files_(files)
{
    list(0, NodePath());
    plan();
}

template <class Coord>
std::uint64_t NodeJobs<Coord>::rows(std::uint32_t node) const
{
    const auto& n = top_.nodes[node];
    if (!n.children[0]) return bins_.rows(n.bin);
    return rows(n.children[0]) + rows(n.children[1]);
}

// Post-order; a side without any points has no job, and then there is no node above.
template <class Coord>
std::optional<std::size_t> NodeJobs<Coord>::list(std::uint32_t number, const NodePath& path)
{
    const auto& node = top_.nodes[number];
    Job job;
    job.path = path;
    if (!node.children[0]) {
        if (bins_.rows(node.bin) == 0) return std::nullopt;
        job.bin = node.bin;
        job.histogram = levels_.histogram(node.bin);
    } else {
        const bool empty[2] = {rows(node.children[0]) == 0, rows(node.children[1]) == 0};
        if (empty[0] && empty[1]) return std::nullopt;
        if (empty[0] || empty[1]) return list(node.children[empty[0] ? 1 : 0], path);
        job.inputs[0] = *list(node.children[0], path.child(0));
        job.inputs[1] = *list(node.children[1], path.child(1));
        job.histogram = jobs_[job.inputs[0]].histogram;
        for (std::size_t level = 0; level < job.histogram.size(); ++level)
            job.histogram[level] += jobs_[job.inputs[1]].histogram[level];
    }
    jobs_.push_back(std::move(job));
    return jobs_.size() - 1;
}

// From the root down: each node above the bins takes the levels that fit.
template <class Coord>
void NodeJobs<Coord>::plan()
{
    for (std::size_t j = jobs_.size(); j-- > 0;) {
        Job& job = jobs_[j];
        if (job.bin) continue;
        job.own = levels_that_fit(job.histogram, job.above.empty() ? 0 : job.above.back().last, options_.chunk_points);
        std::vector<LevelRange> above = job.above;
        above.push_back(job.own);
        for (const std::size_t input : job.inputs) jobs_[input].above = above;
    }
}

template <class Coord>
auto NodeJobs<Coord>::build(Builder& builder, Job& job, typename Builder::Region left, typename Builder::Region right,
                            typename Builder::Output& output) const -> typename Builder::Region
{
    if (!job.bin) return builder.merge(std::move(left), std::move(right), job.path, job.own, output);
    const LeveledRows points{bins_.read(*job.bin), levels_.levels(*job.bin)};
    return builder.build(points, job.path, job.above, output);
}

template <class Coord>
Draft* NodeJobs<Coord>::run(unsigned threads, const std::function<void(std::uint64_t)>& progress)
{
    if (jobs_.empty()) return nullptr;
    Signal signal;
    std::map<std::size_t, typename Builder::Output> waiting;  // finished ahead of their turn
    std::size_t next_commit = 0;
    std::uint64_t points_done = 0;
    bool committing = false;

    const auto ready = [&](const Job& job) {
        return !job.claimed && (job.bin || (jobs_[job.inputs[0]].done && jobs_[job.inputs[1]].done));
    };
    // The next job that can be done, not far ahead of what is committed. Nothing when none is left.
    const auto next_job = [&](std::unique_lock<std::mutex>& lock) -> std::optional<std::size_t> {
        for (;;) {
            if (signal.stopped) return std::nullopt;
            bool any_left = false;
            for (std::size_t j = next_commit; j < jobs_.size(); ++j) {
                any_left = any_left || !jobs_[j].claimed;
                if (j <= next_commit + 2 * threads && ready(jobs_[j])) return j;
                if (any_left && j > next_commit + 2 * threads) break;
            }
            if (!any_left) return std::nullopt;
            signal.wake.wait(lock);
        }
    };
    const auto work = [&] {
        Builder builder(options_, drafts_);
        std::unique_lock lock(signal.mutex);
        while (const auto mine = next_job(lock)) {
            Job& job = jobs_[*mine];
            job.claimed = true;
            typename Builder::Region left, right;
            if (!job.bin) {
                left = std::move(jobs_[job.inputs[0]].region);
                right = std::move(jobs_[job.inputs[1]].region);
            }
            lock.unlock();
            typename Builder::Output output;
            typename Builder::Region region = build(builder, job, std::move(left), std::move(right), output);
            lock.lock();
            job.region = std::move(region);
            job.done = true;
            if (job.bin) points_done += bins_.rows(*job.bin);
            waiting.emplace(*mine, std::move(output));
            // One thread at a time writes what is next in turn.
            while (!committing && !waiting.empty() && waiting.begin()->first == next_commit) {
                committing = true;
                const typename Builder::Output next = std::move(waiting.begin()->second);
                waiting.erase(waiting.begin());
                lock.unlock();
                for (const auto& piece : next.pieces) files_.append(*piece.draft, next.bytes.data() + piece.from, piece.size);
                lock.lock();
                committing = false;
                ++next_commit;
            }
            signal.wake.notify_all();
        }
    };
    Crew crew(signal);
    for (unsigned t = 0; t < threads; ++t) crew.add(work);
    crew.join([&] {
        std::uint64_t done;
        {
            const std::lock_guard lock(signal.mutex);
            done = points_done;
        }
        progress(done);
    });
    return jobs_.back().region.draft;
}

template class NodeJobs<std::uint32_t>;
template class NodeJobs<std::uint64_t>;

}  // namespace pcm
