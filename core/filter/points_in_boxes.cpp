#include "pcm/filter/points_in_boxes.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace pcm {
namespace {

bool touches(const Box3i& a, const Box3i& b)
{
    for (std::size_t i = 0; i < 3; ++i)
        if (a.min[i] > b.max[i] || b.min[i] > a.max[i]) return false;
    return true;
}

bool holds(const Box3i& outer, const Box3i& inner) { return outer.contains(inner.min) && outer.contains(inner.max); }

// Those of the positions relative to `origin` that lie in the box.
template <class Relative>
void select(const std::array<const Relative*, 3>& xyz, const Vec3i& origin, std::uint32_t points, const Box3i& box,
            std::vector<std::uint32_t>& indices)
{
    std::array<std::uint64_t, 3> low{}, span{};
    for (std::size_t a = 0; a < 3; ++a) {
        if (box.max[a] < origin[a]) return;
        const std::int64_t least = std::max(box.min[a], origin[a]);
        low[a] = static_cast<std::uint64_t>(least) - static_cast<std::uint64_t>(origin[a]);
        span[a] = static_cast<std::uint64_t>(box.max[a]) - static_cast<std::uint64_t>(least);
    }
    indices.resize(points);
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < points; ++i) {
        indices[kept] = i;
        kept += (xyz[0][i] - low[0] <= span[0]) & (xyz[1][i] - low[1] <= span[1]) & (xyz[2][i] - low[2] <= span[2]);
    }
    indices.resize(kept);
}

}  // namespace

std::vector<NodeId> PointsInBoxes::nodes(const Box3i& box) const
{
    std::vector<NodeId> open, found;
    if (!tree_->nodes().empty()) open.push_back(0);
    while (!open.empty()) {
        const NodeId id = open.back();
        open.pop_back();
        const Node& node = tree_->node(id);
        if (node.subtree_points == 0 || !touches(node.box, box)) continue;
        if (node.points > 0) found.push_back(id);
        for (std::size_t k = 2; k-- > 0;)
            if (node.children[k] != no_node) open.push_back(node.children[k]);
    }
    return found;
}

PointsInBox PointsInBoxes::read(NodeId id, const Box3i& box, const ColumnSet& columns) const
{
    PointsInBox part;
    if (holds(box, tree_->node(id).box)) {
        part.chunk = tree_->read_chunk(id, columns);
        return part;
    }
    const auto wanted = [&](const Box3i& segment, std::uint16_t) { return touches(segment, box); };
    part.chunk = tree_->read_chunk_part(id, columns, wanted).chunk;
    if (part.chunk.points == 0) return part;
    const ChunkPositions& at = *part.chunk.positions;
    if (at.wide)
        select<std::uint64_t>({at.wide_xyz[0].data(), at.wide_xyz[1].data(), at.wide_xyz[2].data()}, at.origin,
                              part.chunk.points, box, part.indices);
    else
        select<std::uint32_t>({at.narrow_xyz[0].data(), at.narrow_xyz[1].data(), at.narrow_xyz[2].data()}, at.origin,
                              part.chunk.points, box, part.indices);
    part.all = part.indices.size() == part.chunk.points;
    return part;
}

void PointsInBoxes::visit(const Box3i& box, const ColumnSet& columns,
                          const std::function<bool(PointsInBox&)>& take) const
{
    for (const NodeId id : nodes(box)) {
        PointsInBox part = read(id, box, columns);
        if (part.size() > 0 && !take(part)) return;
    }
}

void PointsInBoxes::append(const PointsInBox& points, std::array<std::vector<double>, 3>& to) const
{
    const ChunkPositions& at = *points.chunk.positions;
    const std::size_t before = to[0].size(), count = points.size();
    for (std::size_t a = 0; a < 3; ++a) {
        to[a].resize(before + count);
        double* const out = to[a].data() + before;
        for (std::size_t i = 0; i < count; ++i) out[i] = source(at.grid(points.index(i), a), a);
    }
}

}  // namespace pcm
