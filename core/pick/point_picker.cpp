#include "pcm/pick/point_picker.h"

#include "pcm/cloud/numbers.h"
#include "pcm/pick/pick_cone.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <queue>
#include <tuple>
#include <utility>

namespace pcm {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Selection selection_of(const PickOptions& options)
{
    Selection selection;
    selection.where = options.where;
    selection.clips = options.clips;
    return selection;
}

void check(const PickOptions& options)
{
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw Error(ErrorCode::invalid_argument, {}, what);
    };
    require(options.tolerance_px > 0 && std::isfinite(options.tolerance_px),
            "the tolerance of a pick is " + exact(options.tolerance_px) + " pixels; it must be above 0");
    require(options.largest_px >= options.tolerance_px && std::isfinite(options.largest_px),
            "the largest splat of a pick is " + exact(options.largest_px) +
                " pixels; it must be at least the tolerance, " + exact(options.tolerance_px));
    require(!std::isnan(options.most_depth), "the largest depth of a pick is not a number");
    require(options.size_scale >= 0 && std::isfinite(options.size_scale),
            "the scale of points' sizes is " + exact(options.size_scale) + "; it must be 0 or more");
}

// One pick. One thread, but the tasks that read.
class Search {
public:
    Search(L2Cache& cache, const PointSizes& sizes, BlockCache& blocks, const PickRay& ray, const PickOptions& options)
        : cache_(cache),
          tree_(cache.tree()),
          sizes_(sizes),
          blocks_(blocks),
          options_(options),
          selector_(selection_of(options), tree_.info().schema),
          cone_(ray, options, tree_.info())
    {
        best_depth_ = options.most_depth;
        columns_.sizes = true;
        for (const std::size_t k : selector_.tested()) columns_.attributes.set(k);
        if (const auto place = tree_.info().schema.find(attribute_name::radius)) columns_.attributes.set(*place);
        if (!tree_.nodes().empty()) queue(0, infinity);
    }

    void in_memory();
    void read_all(TaskPool& pool);
    void know(const PickHit& hit)
    {
        if (may_hold(hit.depth)) take(hit);
    }
    PickResult result(double start);

private:
    struct Waiting {
        double depth;  // no point of the subtree is nearer
        NodeId node;
        double limit;  // limit of the radii of its points
        bool operator>(const Waiting& o) const { return std::tie(depth, node) > std::tie(o.depth, o.node); }
    };
    struct Job {
        Waiting of;
        std::optional<ChunkPart> part;
        L2Cache::Handle whole;  // where the cache has changes
        std::shared_ptr<Task> task;
    };

    bool may_hold(double depth) const { return depth <= best_depth_.load(std::memory_order_relaxed); }
    bool may_hold(const Box3d& box, double limit) const
    {
        const auto depth = cone_.least_depth(box, limit);
        return depth && may_hold(*depth) &&
               (!selector_.tests_points() || selector_.relation(box) != BoxRelation::outside);
    }
    void queue(NodeId id, double limit);
    std::optional<Waiting> next();
    void take(const PickHit& hit)
    {
        best_ = hit;
        best_depth_ = hit.depth;
    }
    std::uint16_t level_of(const Node& node, std::uint32_t number) const;
    void read(Job& job) const;
    void look_at(const Job& job);
    void look_at_whole(NodeId id, const Chunk& chunk);
    void look_at_points(NodeId id, const Chunk& chunk, std::uint32_t begin, std::uint32_t end, std::uint32_t number,
                        double limit);
    void try_point(NodeId id, const Chunk& chunk, std::uint32_t i, std::uint32_t number, const Vec3d& p,
                   const PickCone::Place& place, double limit);
    bool is_shown(const Chunk& chunk, std::uint32_t i, const Vec3d& p) const;

    L2Cache& cache_;
    const Tree& tree_;
    const PointSizes& sizes_;
    BlockCache& blocks_;
    const PickOptions& options_;
    const Selector selector_;
    const PickCone cone_;
    ColumnSet columns_;
    bool waits_ = true;  // for nodes to be read
    std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> nodes_;
    std::optional<PickHit> best_;
    std::atomic<double> best_depth_{infinity};
    // The chunk, or part of one, that is looked at; empty until needed.
    std::vector<float> radii_;
    std::vector<PointShape> shapes_;
    std::vector<std::uint32_t> segments_;  // points of its segments
    PickResult counts_;
};

void Search::queue(NodeId id, double limit)
{
    const Node* const found = waits_ ? &tree_.node(id) : tree_.nodes().find(id);
    if (!found || found->box.empty()) return;
    const Node& node = *found;
    // Points below a node are of finer levels than its own.
    if (node.points > 0) limit = std::min(limit, cone_.limit(node.first_level));
    const Box3d box = tree_.box(id);
    const auto depth = cone_.least_depth(box, limit);
    if (!depth || !may_hold(*depth)) return;
    if (selector_.tests_points() && selector_.relation(box) == BoxRelation::outside) return;
    nodes_.push({*depth, id, limit});
}

// The nearest node that can hold a better point, with its children queued.
std::optional<Search::Waiting> Search::next()
{
    while (!nodes_.empty()) {
        const Waiting nearest = nodes_.top();
        if (!may_hold(nearest.depth)) return std::nullopt;
        nodes_.pop();
        const Node& node = tree_.node(nearest.node);
        for (const NodeId child : node.children)
            if (child != no_node) queue(child, nearest.limit);
        if (node.points > 0) return nearest;
    }
    return std::nullopt;
}

void Search::in_memory()
{
    waits_ = false;
    while (const auto of = next())
        if (const L2Cache::Handle chunk = cache_.find(of->node, columns_)) look_at_whole(of->node, *chunk);
}

void Search::read_all(TaskPool& pool)
{
    const unsigned most = std::clamp(options_.reads_in_flight, 1u, TaskPool::most_threads);
    std::deque<std::unique_ptr<Job>> jobs;
    struct Cancel {
        std::deque<std::unique_ptr<Job>>& jobs;
        ~Cancel()
        {
            for (const auto& job : jobs) job->task->cancel();
        }
    } cancel{jobs};
    for (;;) {
        if (options_.cancelled && options_.cancelled()) throw Error(ErrorCode::cancelled, {}, "cancelled");
        while (jobs.size() < most) {
            const auto of = next();
            if (!of) break;
            if (const L2Cache::Handle chunk = cache_.find(of->node, columns_)) {
                look_at_whole(of->node, *chunk);
                continue;
            }
            auto job = std::make_unique<Job>();
            job->of = *of;
            job->task = std::make_shared<Task>([this, job = job.get()] { read(*job); });
            jobs.push_back(std::move(job));
            // The caller runs the first one itself.
            if (jobs.size() > 1) pool.submit(jobs.back()->task, most - 1);
        }
        if (jobs.empty()) return;
        const std::unique_ptr<Job> job = std::move(jobs.front());
        jobs.pop_front();
        if (!may_hold(job->of.depth)) {
            job->task->cancel();
            continue;
        }
        job->task->finish();
        ++counts_.read;
        look_at(*job);
    }
}

// On any thread.
void Search::read(Job& job) const
{
    const Grid& grid = tree_.info().grid;
    job.part = cache_.read_part(job.of.node, columns_, [&](const Box3i& box, std::uint16_t level) {
        return may_hold(grid.to_source(box), cone_.limit(level));
    });
    if (!job.part) job.whole = cache_.get(job.of.node, columns_);
}

void Search::look_at(const Job& job)
{
    if (!job.part) return look_at_whole(job.of.node, *job.whole);
    ++counts_.chunks;
    const Node& node = tree_.node(job.of.node);
    const ChunkPart& part = *job.part;
    radii_.clear();
    segments_.assign(part.count.begin(), part.count.end());
    for (std::size_t k = 0, begin = 0; k < part.first.size(); begin += part.count[k], ++k)
        look_at_points(job.of.node, part.chunk, static_cast<std::uint32_t>(begin),
                       static_cast<std::uint32_t>(begin + part.count[k]), part.first[k],
                       cone_.limit(level_of(node, part.first[k])));
}

void Search::look_at_whole(NodeId id, const Chunk& chunk)
{
    ++counts_.chunks;
    const auto parts = blocks_.get(id, tree_, *chunk.positions);
    const Node& node = tree_.node(id);
    radii_.clear();
    segments_ = points_of_segments(node);
    for (std::size_t g = 0; g < parts->groups.size(); ++g) {
        const std::uint32_t first_block = parts->group_first[g], end_block = parts->group_first[g + 1];
        const double limit = cone_.limit(level_of(node, parts->first[first_block]));
        if (!may_hold(parts->groups.box(g), limit)) continue;
        for (std::uint32_t b = first_block; b < end_block; ++b)
            if (may_hold(parts->blocks.box(b), limit))
                look_at_points(id, chunk, parts->first[b], parts->first[b + 1], parts->first[b], limit);
    }
}

std::uint16_t Search::level_of(const Node& node, std::uint32_t number) const
{
    std::size_t level = 0;
    for (std::uint64_t end = 0; level < node.level_points.size(); ++level)
        if (number < (end += node.level_points[level])) break;
    return static_cast<std::uint16_t>(node.first_level + level);
}

// The points [begin, end) of the chunk, which are one level's; `number` is that of the first one in the whole chunk.
void Search::look_at_points(NodeId id, const Chunk& chunk, std::uint32_t begin, std::uint32_t end, std::uint32_t number,
                            double limit)
{
    const ChunkPositions& positions = *chunk.positions;
    const Grid& grid = tree_.info().grid;
    counts_.outcome.points_in += end - begin;
    for (std::uint32_t i = begin; i < end; ++i) {
        const Vec3d p = grid.to_source(positions.grid(i));
        const PickCone::Place place = cone_.place_of(p);
        if (!cone_.shows(place.t)) continue;
        const double most = cone_.reach_at(place.t, limit);
        if (place.square <= most * most * (1 + 1e-14)) try_point(id, chunk, i, number + (i - begin), p, place, limit);
    }
}

void Search::try_point(NodeId id, const Chunk& chunk, std::uint32_t i, std::uint32_t number, const Vec3d& p,
                       const PickCone::Place& place, double limit)
{
    if (radii_.empty()) {
        if (options_.fitted) find_shapes(*chunk.positions, tree_.info().grid.scale, segments_, shapes_);
        sizes_.find_radii(id, chunk, radii_, options_.fitted ? &shapes_ : nullptr);
    }
    const auto size = static_cast<double>(radii_[i]);
    const double radius = std::min(options_.size_scale * size, limit);
    const double reach = cone_.reach_at(place.t, radius), off_axis = std::sqrt(place.square);
    if (off_axis > reach) return;
    PickHit hit{id, number, cone_.depth(place, reach), place.t, off_axis, size, p};
    if (!may_hold(hit.depth)) return;
    if (best_ && std::tie(hit.depth, hit.node, hit.index) >= std::tie(best_->depth, best_->node, best_->index)) return;
    if (is_shown(chunk, i, p)) take(hit);
}

bool Search::is_shown(const Chunk& chunk, std::uint32_t i, const Vec3d& p) const
{
    if (!selector_.tests_points()) return true;
    std::vector<const Column*> columns;
    for (const auto& column : chunk.attributes) columns.push_back(column.get());
    std::vector<std::uint32_t> selected{i};
    selector_.narrow(
        columns, [&](std::size_t) { return p; }, selected);
    return !selected.empty();
}

PickResult Search::result(double start)
{
    counts_.hit = best_;
    if (best_) counts_.hit->position = SourceRounding(tree_.info())(best_->position);
    counts_.outcome.points_out = best_ ? 1 : 0;
    counts_.outcome.seconds = now() - start;
    return counts_;
}

}  // namespace

PointPicker::PointPicker(L2Cache& cache) : cache_(cache), sizes_(cache.tree()) {}

PickResult PointPicker::in_memory(const PickRay& ray, const PickOptions& options)
{
    check(options);
    const double start = now();
    Search search(cache_, sizes_, blocks_, ray, options);
    search.in_memory();
    return search.result(start);
}

PickResult PointPicker::exact(const PickRay& ray, const PickOptions& options, const std::optional<PickHit>& known)
{
    check(options);
    const double start = now();
    Search search(cache_, sizes_, blocks_, ray, options);
    if (known) search.know(*known);
    search.read_all(pool_);
    return search.result(start);
}

}  // namespace pcm
