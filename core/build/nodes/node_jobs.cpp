#include "pcm/build/nodes/node_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/nodes/point_sizes.h"
#include "pcm/system/error.h"
#include "pcm/threads/ordered.h"

namespace pcm {
namespace {

void put_draft(ByteWriter& out, const Draft& draft)
{
    out.put(draft.path.depth);
    for (const std::uint64_t bits : draft.path.bits) out.put(bits);
    for (const std::int64_t c : draft.box.min) out.put(c);
    for (const std::int64_t c : draft.box.max) out.put(c);
    out.put(draft.points);
    out.put(draft.first_level);
    out.put(static_cast<std::uint32_t>(draft.level_points.size()));
    for (const std::uint32_t points : draft.level_points) out.put(points);
    out.put(draft.spacing);
    out.put(draft.extent.file);
    out.put(draft.extent.offset);
    out.put(draft.extent.bytes);
    out.put(draft.extent.header_bytes);
    for (const Draft* child : draft.children) out.put(static_cast<std::uint8_t>(child != nullptr));
}

// Sets `has_child`; the children are not linked.
Draft* get_draft(ByteReader& in, DraftStore& drafts, std::array<bool, 2>& has_child)
{
    NodePath path;
    path.depth = in.get<std::uint16_t>();
    for (std::uint64_t& bits : path.bits) bits = in.get<std::uint64_t>();
    Draft* draft = drafts.add(path);
    for (std::int64_t& c : draft->box.min) c = in.get<std::int64_t>();
    for (std::int64_t& c : draft->box.max) c = in.get<std::int64_t>();
    draft->points = in.get<std::uint32_t>();
    draft->first_level = in.get<std::uint16_t>();
    const auto levels = in.get<std::uint32_t>();
    for (std::uint32_t i = 0; i < levels; ++i) draft->level_points.push_back(in.get<std::uint32_t>());
    draft->spacing = in.get<double>();
    draft->extent.file = in.get<std::uint32_t>();
    draft->extent.offset = in.get<std::uint64_t>();
    draft->extent.bytes = in.get<std::uint64_t>();
    draft->extent.header_bytes = in.get<std::uint32_t>();
    for (bool& has : has_child) has = in.get<std::uint8_t>() != 0;
    return draft;
}

void put_subtree(ByteWriter& out, const Draft& draft)
{
    put_draft(out, draft);
    for (const Draft* child : draft.children)
        if (child) put_subtree(out, *child);
}

Draft* get_subtree(ByteReader& in, DraftStore& drafts, DataFiles& files)
{
    std::array<bool, 2> has_child{};
    Draft* draft = get_draft(in, drafts, has_child);
    files.written(*draft);
    if (draft->path.depth > NodePath::max_depth)
        throw Error(ErrorCode::corrupt, {}, "a checkpoint has an invalid tree of nodes");
    for (std::size_t side = 0; side < 2; ++side)
        if (has_child[side]) {
            draft->children[side] = get_subtree(in, drafts, files);
            if (draft->children[side]->path.depth != draft->path.depth + 1)
                throw Error(ErrorCode::corrupt, {}, "a checkpoint has an invalid tree of nodes");
        }
    return draft;
}

}  // namespace

template <class Coord>
NodeJobs<Coord>::NodeJobs(const TopTree<Coord>& top, const SortedBins<Coord>& bins, const LevelSampler<Coord>& levels,
                          const NodeBuilderOptions& options, DraftStore& drafts, DataFiles& files)
    : top_(top), bins_(bins), levels_(levels), options_(options), drafts_(drafts), files_(files)
{
    list(0, NodePath());
    plan();
    if (!jobs_.empty()) files_.choose_front(jobs_.back().histogram);  // the root's
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
LeveledRows NodeJobs<Coord>::rows_of(std::size_t bin) const
{
    LeveledRows points{bins_.read(bin), levels_.levels(bin), {}};
    points.sizes = find_sizes<Coord>(points.rows.data(), points.levels.size(), options_.layout.bytes, options_.grid);
    return points;
}

template <class Coord>
auto NodeJobs<Coord>::build(Builder& builder, Job& job, typename Builder::Region left, typename Builder::Region right,
                            typename Builder::Output& output) const -> typename Builder::Region
{
    if (!job.bin) return builder.merge(std::move(left), std::move(right), job.path, job.own, output);
    return builder.build(rows_of(*job.bin), job.path, job.above, output);
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
        job.region.draft = get_subtree(in, drafts_, files_);
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
        region = builder.hand_up(rows_of(*job.bin), job.above);
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
