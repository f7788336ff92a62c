#include "pcm/knn/unit_points.h"

#include "pcm/knn/grid_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pcm {
namespace {

bool meet(const Box3i& a, const Box3i& b)
{
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (a.min[axis] > b.max[axis] || b.min[axis] > a.max[axis]) return false;
    return true;
}

// Nodes whose own points may lie in a box.
void nodes_in(const Tree& tree, NodeId id, const Box3i& box, std::vector<NodeId>& nodes)
{
    const Node& node = tree.node(id);
    if (node.box.empty() || !meet(node.box, box)) return;
    if (node.points > 0) nodes.push_back(id);
    for (const NodeId child : node.children)
        if (child != no_node) nodes_in(tree, child, box, nodes);
}

// Indices of the chunk's points in each of two boxes, the second of which holds the first: those in the first, and the
// others.
void divide(const ChunkPositions& positions, const Box3i& inner, const Box3i& outer, std::vector<std::uint32_t>& in,
            std::vector<std::uint32_t>& around)
{
    in.clear();
    around.clear();
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const Vec3i at = positions.grid(i);
        if (!outer.contains(at)) continue;
        (inner.contains(at) ? in : around).push_back(i);
    }
}

class Gatherer {
public:
    Gatherer(GatheredPoints& result, const Vec3d& scale) : result_(result)
    {
        bool narrow = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::uint64_t extent = grid_steps(result.loaded.min[axis], result.loaded.max[axis]);
            narrow = narrow && extent < (std::uint64_t(1) << 30);
            result.origin[axis] =
                static_cast<std::int64_t>(static_cast<std::uint64_t>(result.loaded.min[axis]) + extent / 2);
        }
        narrow_ = narrow;
        result.positions.scale = scale;
    }
    void add(const ChunkPositions& positions, const std::vector<std::uint32_t>& indices)
    {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            auto& narrow = result_.positions.narrow[axis];
            auto& wide = result_.positions.wide[axis];
            const std::int64_t origin = result_.origin[axis];
            for (const std::uint32_t i : indices) {
                const std::int64_t relative = positions.grid(i, axis) - origin;
                if (narrow_)
                    narrow.push_back(static_cast<std::int32_t>(relative));
                else
                    wide.push_back(relative);
            }
        }
    }

private:
    GatheredPoints& result_;
    bool narrow_ = true;
};

}  // namespace

Box3i box_around(const Box3i& box, double margin, const TreeInfo& info)
{
    Box3i result = box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double wanted = std::ceil(margin / info.grid.scale[axis]) + 1;
        const auto grow = [&](std::int64_t& side, std::int64_t limit, int sign) {
            const std::uint64_t room = sign < 0 ? grid_steps(limit, side) : grid_steps(side, limit);
            side = wanted < double(room) ? side + sign * static_cast<std::int64_t>(wanted) : limit;
        };
        grow(result.min[axis], std::min(info.box.min[axis], box.min[axis]), -1);
        grow(result.max[axis], std::max(info.box.max[axis], box.max[axis]), 1);
    }
    return result;
}

double GatheredPoints::reach(std::uint32_t number, const Box3i& cloud) const
{
    double reach = std::numeric_limits<double>::infinity();
    const Vec3i at = grid(number);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double scale = positions.scale[axis];
        if (loaded.min[axis] > cloud.min[axis])
            reach = std::min(reach, (double(grid_steps(loaded.min[axis], at[axis])) + 1) * scale);
        if (loaded.max[axis] < cloud.max[axis])
            reach = std::min(reach, (double(grid_steps(at[axis], loaded.max[axis])) + 1) * scale);
    }
    return reach * (1 - 1e-12);
}

Vec3i GatheredPoints::grid(std::uint32_t number) const
{
    Vec3i at;
    for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis] = origin[axis] + (positions.is_wide() ? positions.wide[axis][number] : positions.narrow[axis][number]);
    return at;
}

void GatheredPoints::put_offsets(std::size_t axis, std::uint32_t from, const std::uint32_t* to, std::size_t count,
                                 double* offsets) const
{
    const double scale = positions.scale[axis];
    const auto put = [&](const auto& column) {
        const auto* const all = column.data();
        const std::int64_t origin_of_offsets = all[from];
        for (std::size_t j = 0; j < count; ++j) offsets[j] = double(all[to[j]] - origin_of_offsets) * scale;
    };
    if (positions.is_wide())
        put(positions.wide[axis]);
    else
        put(positions.narrow[axis]);
}

GatheredPoints gather_unit(L2Cache& cache, const Box3i& box, double margin, const ColumnSet& columns)
{
    const Tree& tree = cache.tree();
    const TreeInfo& info = tree.info();
    GatheredPoints result;
    result.box = box;
    result.loaded = box_around(box, margin, info);
    Gatherer gatherer(result, info.grid.scale);
    std::vector<NodeId> nodes;
    nodes_in(tree, 0, result.loaded, nodes);
    std::vector<L2Cache::Handle> chunks_around;
    std::vector<std::uint32_t> in, around;
    for (const NodeId node : nodes) {
        L2Cache::Handle chunk = cache.get(node, ColumnSet::only_positions());
        divide(*chunk->positions, box, result.loaded, in, around);
        if (!in.empty()) {
            NeighbourhoodUnit::Part part;
            part.node = node;
            part.first = result.unit.points;
            part.indices = in;
            result.unit.points += static_cast<std::uint32_t>(in.size());
            gatherer.add(*chunk->positions, in);
            part.chunk = cache.get(node, columns);
            result.unit.parts.push_back(std::move(part));
        }
        if (around.empty()) continue;
        result.unit.around.push_back({node, {}, around, 0});
        chunks_around.push_back(std::move(chunk));
    }
    std::uint32_t next = result.unit.points;
    for (std::size_t i = 0; i < chunks_around.size(); ++i) {
        NeighbourhoodUnit::Part& part = result.unit.around[i];
        part.first = next;
        next += static_cast<std::uint32_t>(part.indices.size());
        gatherer.add(*chunks_around[i]->positions, part.indices);
    }
    return result;
}

}  // namespace pcm
