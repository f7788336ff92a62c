#include "pcm/knn/point_search.h"

#include "pcm/cloud/box_distance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

namespace pcm {
namespace {

bool before(const Neighbour& a, const Neighbour& b)
{
    return std::tie(a.squared_distance, a.node, a.index) < std::tie(b.squared_distance, b.node, b.index);
}

}  // namespace

double Neighbour::distance() const { return std::sqrt(squared_distance); }

PointSearch::PointSearch(L2Cache& cache, BlockCache& blocks, const std::optional<std::uint16_t>& level,
                         double max_distance)
    : chunks_(cache, blocks, level), rounding_(cache.tree().info()), limit_(max_distance * max_distance)
{
}

void PointSearch::run(const Vec3d& q, std::size_t k, std::vector<Neighbour>& result)
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

void PointSearch::within(const Vec3d& q, double distance, const SeeBlock& see)
{
    const Tree& tree = chunks_.tree();
    const double limit = distance * distance;
    std::vector<NodeId> nodes;
    if (!tree.nodes().empty()) nodes.push_back(0);
    std::vector<double> squares;
    while (!nodes.empty()) {
        const NodeId id = nodes.back();
        nodes.pop_back();
        const Node& node = tree.node(id);
        if (node.box.empty() || !chunks_.passes(node)) continue;
        if (!(squared_distance(chunks_.grid().to_source(node.box), q) <= limit)) continue;
        for (const NodeId child : node.children)
            if (child != no_node) nodes.push_back(child);
        if (node.points == 0) continue;
        const HeldChunk& chunk = chunks_.get(id);
        squares.resize(chunk.end_block);
        squares_of(chunk.blocks->blocks, 0, chunk.end_block, q, squares.data());
        for (std::size_t b = 0; b < chunk.end_block; ++b)
            if (squares[b] <= limit)
                see(chunk.positions(), id, static_cast<std::uint32_t>(chunk.blocks->first[b]),
                    static_cast<std::uint32_t>(chunk.blocks->first[b + 1]));
    }
}

// Whether a point of node `id` or its subtree (whose nodes have higher numbers) can be among the best, where
// `square` is a lower bound of the squares.
bool PointSearch::may_hold(double square, NodeId id, std::size_t k) const
{
    if (!(square <= limit_)) return false;
    return best_.size() < k || std::tie(square, id) <= std::tie(best_.front().squared_distance, best_.front().node);
}

void PointSearch::queue_node(NodeId id, const Vec3d& q, std::size_t k)
{
    const Node& node = chunks_.tree().node(id);
    if (node.box.empty() || !chunks_.passes(node)) return;
    const double square = squared_distance(chunks_.grid().to_source(node.box), q);
    if (!may_hold(square, id, k)) return;
    nodes_.emplace_back(square, id);
    std::push_heap(nodes_.begin(), nodes_.end(), std::greater<>());
}

// Calls f for groups or blocks in ascending order of their squares, while they may hold a point for the result.
template <class F>
void PointSearch::in_order(std::vector<Ranked>& ranked, NodeId id, std::size_t k, const F& f)
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

void PointSearch::rank(const PointBlocks::Boxes& boxes, std::size_t begin, std::size_t end, NodeId id, const Vec3d& q,
                       std::size_t k, std::vector<Ranked>& ranked)
{
    squares_.resize(end - begin);
    squares_of(boxes, begin, end, q, squares_.data());
    for (std::size_t i = begin; i < end; ++i)
        if (may_hold(squares_[i - begin], id, k))
            ranked.emplace_back(squares_[i - begin], static_cast<std::uint32_t>(i));
}

void PointSearch::search_chunk(NodeId id, const Vec3d& q, std::size_t k)
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

void PointSearch::search_block(const HeldChunk& chunk, std::uint32_t block, const Vec3d& q, std::size_t k)
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
            const double grid_position = static_cast<double>(positions.origin[a]) + positions.narrow_xyz[a][begin + i];
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

}  // namespace pcm
