#include "pcm/query/nearest.h"

#include "pcm/cloud/box_distance.h"
#include "pcm/cloud/morton.h"
#include "pcm/query/point_blocks.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/threads/crew.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <tuple>

namespace pcm {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// A chunk's positions and blocks, kept between the searches that use them.
struct HeldChunk {
    NodeId node = no_node;
    L2Cache::Handle handle;
    std::shared_ptr<const PointBlocks> blocks;
    std::size_t points = 0, end_block = 0;  // of the level asked for
    const ChunkPositions& positions() const { return *handle->positions; }
};

class HeldChunks {
public:
    HeldChunks(L2Cache& cache, BlockCache& blocks, const std::optional<std::uint16_t>& level)
        : cache_(cache), blocks_(blocks), level_(level)
    {
    }

    const Tree& tree() const { return cache_.tree(); }
    const Grid& grid() const { return tree().info().grid; }
    // Whether the node or its subtree can hold points of the level: finer levels are below a node.
    bool passes(const Node& node) const { return !(level_ && node.points > 0 && node.first_level > *level_); }

    const HeldChunk& get(NodeId id)
    {
        HeldChunk& held = held_[id % held_.size()];
        if (held.node == id) return held;
        held.node = no_node;
        held.handle = cache_.get(id, ColumnSet::only_positions());
        held.blocks = blocks_.get(id, tree(), held.positions());
        held.points = level_ ? tree().node(id).points_to_level(*level_) : held.positions().size();
        // Blocks end where levels end.
        const auto& first = held.blocks->first;
        held.end_block =
            static_cast<std::size_t>(std::lower_bound(first.begin(), first.end() - 1, held.points) - first.begin());
        held.node = id;
        return held;
    }

private:
    L2Cache& cache_;
    BlockCache& blocks_;
    std::optional<std::uint16_t> level_;
    std::array<HeldChunk, 16> held_;
};

// Squared distances of the boxes [begin, end).
void squares_of(const PointBlocks::Boxes& boxes, std::size_t begin, std::size_t end, const Vec3d& q, double* squares)
{
    for (std::size_t i = begin; i < end; ++i) {
        double sum[3];
        for (std::size_t a = 0; a < 3; ++a) {
            const double c = std::min(std::max(q[a], boxes.min[a][i]), boxes.max[a][i]) - q[a];
            sum[a] = c * c;
        }
        squares[i - begin] = (sum[0] + sum[1]) + sum[2];
    }
}

class Search {
public:
    Search(L2Cache& cache, BlockCache& blocks, const NearestOptions& options)
        : chunks_(cache, blocks, options.level),
          rounding_(chunks_.tree().info()),
          limit_(options.max_distance * options.max_distance)
    {
    }

    // Nearest first.
    void run(const Vec3d& q, std::size_t k, std::vector<Neighbour>& result)
    {
        best_.clear();
        const Tree& tree = chunks_.tree();
        if (k > 0 && !tree.nodes().empty()) {
            nodes_.clear();
            queue_node(0, q, k);
            while (!nodes_.empty()) {
                std::pop_heap(nodes_.begin(), nodes_.end(), std::greater<>());
                const auto [square, id] = nodes_.back();
                nodes_.pop_back();
                if (!may_hold(square, id, k)) continue;
                const Node& node = tree.node(id);
                if (node.points > 0) search_chunk(id, q, k);
                for (const NodeId child : node.children)
                    if (child != no_node) queue_node(child, q, k);
            }
        }
        if (rounding_.single_precision() || rounding_.has_decimals()) {
            for (Neighbour& found : best_) {
                found.position = rounding_(found.position);
                found.squared_distance = squared_distance(found.position, q);
            }
            std::sort(best_.begin(), best_.end(), before);
        } else {
            std::sort_heap(best_.begin(), best_.end(), before);
        }
        result = best_;
    }
    std::uint64_t compared() const { return compared_; }

private:
    static bool before(const Neighbour& a, const Neighbour& b)
    {
        return std::tie(a.squared_distance, a.node, a.index) < std::tie(b.squared_distance, b.node, b.index);
    }
    // Whether a point of node `id` or its subtree (whose nodes have higher numbers) can be among the best, where
    // `square` is a lower bound of the squares.
    bool may_hold(double square, NodeId id, std::size_t k) const
    {
        if (!(square <= limit_)) return false;
        return best_.size() < k || std::tie(square, id) <= std::tie(best_.front().squared_distance, best_.front().node);
    }
    void queue_node(NodeId id, const Vec3d& q, std::size_t k)
    {
        const Node& node = chunks_.tree().node(id);
        if (node.box.empty() || !chunks_.passes(node)) return;
        const double square = squared_distance(chunks_.grid().to_source(node.box), q);
        if (!may_hold(square, id, k)) return;
        nodes_.emplace_back(square, id);
        std::push_heap(nodes_.begin(), nodes_.end(), std::greater<>());
    }

    using Ranked = std::pair<double, std::uint32_t>;
    // Calls f for groups or blocks in ascending order of their squares, while they may hold a point for the result.
    template <class F>
    void in_order(std::vector<Ranked>& ranked, NodeId id, std::size_t k, const F& f)
    {
        std::make_heap(ranked.begin(), ranked.end(), std::greater<>());
        while (!ranked.empty()) {
            std::pop_heap(ranked.begin(), ranked.end(), std::greater<>());
            const Ranked next = ranked.back();
            ranked.pop_back();
            if (!may_hold(next.first, id, k)) break;
            f(next.second);
        }
        ranked.clear();
    }
    void rank(const PointBlocks::Boxes& boxes, std::size_t begin, std::size_t end, NodeId id, const Vec3d& q,
              std::size_t k, std::vector<Ranked>& ranked)
    {
        squares_.resize(end - begin);
        squares_of(boxes, begin, end, q, squares_.data());
        for (std::size_t i = begin; i < end; ++i)
            if (may_hold(squares_[i - begin], id, k))
                ranked.emplace_back(squares_[i - begin], static_cast<std::uint32_t>(i));
    }

    void search_chunk(NodeId id, const Vec3d& q, std::size_t k)
    {
        const HeldChunk& chunk = chunks_.get(id);
        const PointBlocks& blocks = *chunk.blocks;
        const auto& group_first = blocks.group_first;
        const auto groups = static_cast<std::size_t>(
            std::lower_bound(group_first.begin(), group_first.end() - 1, chunk.end_block) - group_first.begin());
        rank(blocks.groups, 0, groups, id, q, k, ranked_groups_);
        in_order(ranked_groups_, id, k, [&](std::uint32_t group) {
            const std::size_t end = std::min<std::size_t>(group_first[group + 1], chunk.end_block);
            rank(blocks.blocks, group_first[group], end, id, q, k, ranked_blocks_);
            in_order(ranked_blocks_, id, k, [&](std::uint32_t block) { search_block(chunk, block, q, k); });
        });
    }

    void search_block(const HeldChunk& chunk, std::uint32_t block, const Vec3d& q, std::size_t k)
    {
        const std::size_t begin = chunk.blocks->first[block], count = chunk.blocks->first[block + 1] - begin;
        std::array<double, PointBlocks::block_points> squares;
        const ChunkPositions& positions = chunk.positions();
        const Grid& grid = chunks_.grid();
        constexpr std::int64_t exact_double = std::int64_t(1) << 52;
        bool small = !positions.wide;
        for (const std::int64_t c : positions.origin) small = small && c > -exact_double && c < exact_double;
        if (small) {
            // Sums of integers below 2^53 are exact: the same doubles as from the grid position.
            const auto coordinate = [&](std::size_t a, std::size_t i) {
                const double grid_position =
                    static_cast<double>(positions.origin[a]) + positions.narrow_xyz[a][begin + i];
                return grid_position * grid.scale[a] + grid.offset[a] - q[a];
            };
            for (std::size_t i = 0; i < count; ++i) {
                const double x = coordinate(0, i), y = coordinate(1, i), z = coordinate(2, i);
                squares[i] = (x * x + y * y) + z * z;
            }
        } else {
            for (std::size_t i = 0; i < count; ++i)
                squares[i] = squared_distance(grid.to_source(positions.grid(begin + i)), q);
        }
        compared_ += count;
        for (std::size_t i = 0; i < count; ++i) {
            if (!(squares[i] <= limit_)) continue;
            if (best_.size() == k && squares[i] > best_.front().squared_distance) continue;
            Neighbour found;
            found.node = chunk.node;
            found.index = static_cast<std::uint32_t>(begin + i);
            found.squared_distance = squares[i];
            if (best_.size() == k) {
                if (!before(found, best_.front())) continue;
                std::pop_heap(best_.begin(), best_.end(), before);
                best_.pop_back();
            }
            found.position = grid.to_source(positions.grid(begin + i));
            best_.push_back(found);
            std::push_heap(best_.begin(), best_.end(), before);
        }
    }

    HeldChunks chunks_;
    const SourceRounding rounding_;
    double limit_;
    std::vector<Neighbour> best_;  // a heap, worst first
    std::vector<std::pair<double, NodeId>> nodes_;
    std::vector<Ranked> ranked_groups_, ranked_blocks_;
    std::vector<double> squares_;
    std::uint64_t compared_ = 0;
};

void require(const std::vector<Vec3d>& points, const NearestOptions& options)
{
    for (const Vec3d& p : points)
        if (!is_finite(p))
            throw Error(ErrorCode::invalid_argument, {},
                        "the neighbours of a point that is not finite cannot be searched: " + exact(p));
    if (!(options.max_distance >= 0))
        throw Error(ErrorCode::invalid_argument, {},
                    "the largest distance of neighbours is " + exact(options.max_distance) + "; it must be 0 or more");
}

void give_source_numbers(Hit& hit, const Region& beam, const TreeInfo& info)
{
    hit.position = SourceRounding(info)(hit.position);
    hit.along = beam.along(hit.position);
}

double spacing_at(const Tree& tree, const std::optional<std::uint16_t>& level)
{
    return level ? level_spacing(tree, *level) : 0;
}

double least_distance(const std::vector<Neighbour>& points, double spacing, double max_distance)
{
    const double distance = points.empty() ? max_distance : points[0].distance();
    return spacing == 0 ? distance : std::max(0.0, distance - spacing);
}

constexpr const char* error_meaning = "by how much the nearest point of the whole cloud may be nearer, source units";

double error_of(const std::vector<Neighbour>& points, double spacing, double max_distance)
{
    return std::min(spacing, points.empty() ? max_distance : points[0].distance());
}

}  // namespace

double level_spacing(const Tree& tree, std::uint16_t level)
{
    const TreeInfo& info = tree.info();
    if (level >= info.spacings.size() || level + 1 >= info.levels || tree.points_to_level(level) == info.points)
        return 0;
    return info.coverage_kept ? info.spacings[level] : infinity;
}

double Neighbour::distance() const { return std::sqrt(squared_distance); }

NearestResult find_nearest(L2Cache& cache, BlockCache& blocks, const Vec3d& point, std::size_t k,
                           const NearestOptions& options)
{
    require({point}, options);
    const double start = now();
    NearestResult result;
    Search search(cache, blocks, options);
    search.run(point, k, result.points);
    const double spacing = spacing_at(cache.tree(), options.level);
    result.least_distance = least_distance(result.points, spacing, options.max_distance);
    result.outcome.points_in = search.compared();
    result.outcome.points_out = result.points.size();
    result.outcome.error = error_of(result.points, spacing, options.max_distance);
    result.outcome.error_meaning = error_meaning;
    result.outcome.seconds = now() - start;
    return result;
}

NearestBatch find_nearest(L2Cache& cache, BlockCache& blocks, const std::vector<Vec3d>& points, std::size_t k,
                          const NearestOptions& options)
{
    require(points, options);
    if (points.size() > 0xffffffffu)
        throw Error(ErrorCode::invalid_argument, {}, "more than 4294967295 points were given at once",
                    "search for them in parts");
    const double start = now(), spacing = spacing_at(cache.tree(), options.level);
    const std::vector<std::uint32_t> order = morton_order(points);
    std::vector<std::vector<Neighbour>> found(points.size());
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> compared{0};
    constexpr std::size_t at_once = 256;
    Watch watch(options.progress);
    Signal signal;
    const auto work = [&] {
        Search search(cache, blocks, options);
        for (std::size_t begin; !signal.stopped && (begin = next.fetch_add(at_once)) < order.size();)
            for (std::size_t i = begin; i < std::min(begin + at_once, order.size()); ++i)
                search.run(points[order[i]], k, found[order[i]]);
        compared += search.compared();
    };
    const std::size_t most = (points.size() + at_once - 1) / at_once;
    const std::size_t threads = std::min<std::size_t>(thread_count(options.threads), most);
    {
        Crew crew(signal);
        for (std::size_t t = 0; t < threads; ++t) crew.add(work);
        crew.join([&] {
            const auto begun = static_cast<double>(std::min(next.load(), order.size()));
            watch.report("Searching neighbours",
                         order.empty() ? 1.0 : 0.999 * begun / static_cast<double>(order.size()));
        });
    }
    NearestBatch batch;
    batch.first.push_back(0);
    for (auto& one : found) {
        batch.points.insert(batch.points.end(), one.begin(), one.end());
        batch.first.push_back(batch.points.size());
        batch.least_distance.push_back(least_distance(one, spacing, options.max_distance));
        batch.outcome.error = std::max(batch.outcome.error, error_of(one, spacing, options.max_distance));
        std::vector<Neighbour>().swap(one);
    }
    batch.outcome.points_in = compared;
    batch.outcome.points_out = batch.points.size();
    batch.outcome.error_meaning = error_meaning;
    batch.outcome.seconds = now() - start;
    return batch;
}

HitResult find_first_hit(L2Cache& cache, BlockCache& blocks, const Region& beam,
                         const std::optional<std::uint16_t>& level)
{
    if (beam.kind() != Region::Kind::ray && beam.kind() != Region::Kind::cone)
        throw Error(ErrorCode::invalid_argument, {},
                    "the first point along a region can be found in a ray or a cone only");
    const double start = now();
    HitResult result;
    HeldChunks chunks(cache, blocks, level);
    const Tree& tree = chunks.tree();
    const auto may_hold = [&](double along, NodeId id) {
        return !result.hit || std::tie(along, id) <= std::tie(result.hit->along, result.hit->node);
    };
    std::priority_queue<std::pair<double, NodeId>, std::vector<std::pair<double, NodeId>>, std::greater<>> nodes;
    const auto queue = [&](NodeId id) {
        const Node& node = tree.node(id);
        if (node.box.empty() || !chunks.passes(node)) return;
        const Box3d box = chunks.grid().to_source(node.box);
        const double along = std::max(0.0, beam.least_along(box));
        if (may_hold(along, id) && beam.relation(box) != BoxRelation::outside) nodes.emplace(along, id);
    };
    if (!tree.nodes().empty()) queue(0);
    while (!nodes.empty()) {
        const auto [along, id] = nodes.top();
        nodes.pop();
        if (!may_hold(along, id)) continue;
        const auto is_wanted = [&, node = id](const Box3d& box) {
            return may_hold(std::max(0.0, beam.least_along(box)), node) && beam.relation(box) != BoxRelation::outside;
        };
        if (tree.node(id).points > 0) {
            const HeldChunk& chunk = chunks.get(id);
            const PointBlocks& parts = *chunk.blocks;
            for (std::size_t g = 0; g < parts.groups.size() && parts.group_first[g] < chunk.end_block; ++g) {
                if (!is_wanted(parts.groups.box(g))) continue;
                for (std::size_t b = parts.group_first[g];
                     b < std::min<std::size_t>(parts.group_first[g + 1], chunk.end_block); ++b) {
                    if (!is_wanted(parts.blocks.box(b))) continue;
                    for (std::uint32_t i = parts.first[b]; i < parts.first[b + 1]; ++i) {
                        ++result.outcome.points_in;
                        const Vec3d p = chunks.grid().to_source(chunk.positions().grid(i));
                        const double t = beam.along(p);
                        const bool sooner =
                            !result.hit ||
                            std::tie(t, id, i) < std::tie(result.hit->along, result.hit->node, result.hit->index);
                        if (sooner && beam.contains(p)) result.hit = Hit{id, i, t, p};
                    }
                }
            }
        }
        for (const NodeId child : tree.node(id).children)
            if (child != no_node) queue(child);
    }
    if (result.hit) give_source_numbers(*result.hit, beam, tree.info());
    result.outcome.points_out = result.hit ? 1 : 0;
    result.outcome.error = spacing_at(tree, level);
    result.outcome.error_meaning =
        "every point of the whole cloud has a point of this level nearer than this, source units";
    result.outcome.seconds = now() - start;
    return result;
}

}  // namespace pcm
