#include "pcm/build/nodes/node_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/nodes/draft_record.h"
#include "pcm/system/error.h"
#include "pcm/threads/ordered.h"

namespace pcm {

template <class Coord>
NodeJobs<Coord>::NodeJobs(const TopTree<Coord>& top, const SortedBins<Coord>& bins, const LevelsOfBins& levels,
                          const NodeBuilderOptions& options, DraftStore& drafts, DataFiles& files)
    : bins_(bins), levels_(levels), options_(options), drafts_(drafts), files_(files)
{
    const auto rows = [&](std::size_t bin) { return bins.rows(bin); };
    for (NodeJob& planned : plan_nodes<Coord>(top, rows, levels, options.chunk_points))
        jobs_.push_back({std::move(planned), false, false, {}});
    if (!jobs_.empty()) files_.choose_front(jobs_.back().histogram);  // the root's
}

template <class Coord>
auto NodeJobs<Coord>::build(Builder& builder, Job& job, typename Builder::Region left, typename Builder::Region right,
                            typename Builder::Output& output) const -> typename Builder::Region
{
    if (!job.bin) return builder.merge(std::move(left), std::move(right), job.path, job.own, output);
    return builder.build(leveled_rows(bins_, levels_, options_, *job.bin), job.path, job.above, output);
}

template <class Coord>
void NodeJobs<Coord>::save(std::size_t first, std::size_t last, ByteWriter& out) const
{
    out.put(static_cast<std::uint64_t>(first));
    out.put(static_cast<std::uint64_t>(last));
    for (std::size_t j = first; j < last; ++j) {
        const Draft* draft = jobs_[j].region.draft;
        out.put(static_cast<std::uint8_t>(draft != nullptr));
        if (!draft) continue;
        if (jobs_[j].bin)
            put_subtree(out, *draft);
        else
            put_draft(out, *draft);  // its children are of earlier jobs
    }
    files_.save(out);
}

template <class Coord>
void NodeJobs<Coord>::load(std::size_t number, ByteReader& in)
{
    Job& job = jobs_[number];
    job.claimed = job.done = true;
    if (!in.get<std::uint8_t>()) return;
    if (job.bin) {
        job.region.draft = get_subtree(in, drafts_, [this](Draft& draft) { files_.written(draft); });
    } else {
        std::array<bool, 2> has_child{};
        job.region.draft = get_draft(in, drafts_, has_child);
        files_.written(*job.region.draft);
        for (std::size_t side = 0; side < 2; ++side) {
            Draft* child = jobs_[job.inputs[side]].region.draft;
            if (has_child[side] != (child != nullptr))
                throw Error(ErrorCode::corrupt, {}, "a checkpoint has an invalid tree of nodes");
            job.region.draft->children[side] = child;
        }
    }
    if (!(job.region.draft->path == job.path)) throw Error(ErrorCode::corrupt, {}, "a checkpoint is of other nodes");
}

template <class Coord>
void NodeJobs<Coord>::resume(const std::vector<const std::vector<std::byte>*>& records)
{
    std::size_t next = 0;
    for (std::size_t r = 0; r < records.size(); ++r) {
        ByteReader in(records[r]->data(), records[r]->size(), {});
        const auto first = in.get<std::uint64_t>(), last = in.get<std::uint64_t>();
        if (first != next || last < first || last > jobs_.size())
            throw Error(ErrorCode::corrupt, {}, "a checkpoint is of other nodes");
        for (; next < last; ++next) load(next, in);
        if (r + 1 == records.size()) files_.load(in);
    }
    restored_ = next;
}

// The region of a job that was committed by an interrupted run.
template <class Coord>
auto NodeJobs<Coord>::regained(Builder& builder, std::size_t number) const -> typename Builder::Region
{
    const Job& job = jobs_[number];
    typename Builder::Region region;
    if (job.bin) {
        region = builder.hand_up(leveled_rows(bins_, levels_, options_, *job.bin), job.above);
    } else {
        region = Builder::join(regained(builder, job.inputs[0]), regained(builder, job.inputs[1]));
        region.above.pop_back();
    }
    region.draft = job.region.draft;
    return region;
}

// What the threads of run() share, guarded by the signal's mutex; so are the jobs' claimed, done and region.
template <class Coord>
struct NodeJobs<Coord>::Run {
    Run(unsigned number_of_threads, std::size_t first, const std::function<void(std::size_t)>& on_commit)
        : threads(number_of_threads), commits(first), committed(on_commit)
    {
    }
    const unsigned threads;
    Signal signal;
    OrderedResults<typename Builder::Output> commits;
    const std::function<void(std::size_t)>& committed;
    std::uint64_t points_done = 0;
};

// The next job that can be done, not far ahead of the committed ones, so that few outputs wait. Waits for one; absent
// when none is left.
template <class Coord>
std::optional<std::size_t> NodeJobs<Coord>::next_job(Run& run, std::unique_lock<std::mutex>& lock) const
{
    const auto ready = [&](const Job& job) {
        return !job.claimed && (job.bin || (jobs_[job.inputs[0]].done && jobs_[job.inputs[1]].done));
    };
    for (;;) {
        if (run.signal.stopped) return std::nullopt;
        bool any_left = false;
        const std::size_t far = run.commits.next() + 2 * run.threads;
        for (std::size_t j = run.commits.next(); j < jobs_.size(); ++j) {
            any_left = any_left || !jobs_[j].claimed;
            if (j <= far && ready(jobs_[j])) return j;
            if (any_left && j > far) break;
        }
        if (!any_left) return std::nullopt;
        run.signal.wake.wait(lock);
    }
}

// The regions of a job's inputs: of those that were restored, or of those of this run.
template <class Coord>
void NodeJobs<Coord>::take_inputs(Builder& builder, const Job& job, bool restored, typename Builder::Region& left,
                                  typename Builder::Region& right)
{
    if (job.bin) return;
    for (auto* side : {&left, &right}) {
        const std::size_t input = job.inputs[side == &right];
        if ((input < restored_) != restored) continue;
        *side = restored ? regained(builder, input) : std::move(jobs_[input].region);
    }
}

template <class Coord>
void NodeJobs<Coord>::work(Run& run)
{
    Builder builder(options_, drafts_);
    std::unique_lock lock(run.signal.mutex);
    while (const auto mine = next_job(run, lock)) {
        Job& job = jobs_[*mine];
        job.claimed = true;
        typename Builder::Region left, right;
        take_inputs(builder, job, false, left, right);
        lock.unlock();
        take_inputs(builder, job, true, left, right);  // reads from the disk
        typename Builder::Output output;
        typename Builder::Region region = build(builder, job, std::move(left), std::move(right), output);
        lock.lock();
        job.region = std::move(region);
        job.done = true;
        if (job.bin) run.points_done += bins_.rows(*job.bin);
        run.commits.add(lock, *mine, std::move(output), [&](std::size_t number, typename Builder::Output next) {
            for (const auto& piece : next.pieces)
                files_.append(*piece.draft, next.bytes.data() + piece.from, piece.size);
            run.committed(number + 1);
        });
        run.signal.wake.notify_all();
    }
}

template <class Coord>
Draft* NodeJobs<Coord>::run(unsigned threads, const std::function<void(std::uint64_t)>& progress,
                            const std::function<void(std::size_t)>& committed)
{
    if (jobs_.empty()) return nullptr;
    Run run(threads, restored_, committed);
    for (std::size_t j = 0; j < restored_; ++j)
        if (jobs_[j].bin) run.points_done += bins_.rows(*jobs_[j].bin);
    Crew crew(run.signal);
    for (unsigned t = 0; t < threads; ++t) crew.add([&] { work(run); });
    crew.join([&] {
        std::uint64_t done;
        {
            const std::lock_guard lock(run.signal.mutex);
            done = run.points_done;
        }
        progress(done);
    });
    return jobs_.back().region.draft;
}

template class NodeJobs<std::uint32_t>;
template class NodeJobs<std::uint64_t>;

}  // namespace pcm
