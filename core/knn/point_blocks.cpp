#include "pcm/knn/point_blocks.h"

#include <algorithm>

namespace pcm {

void PointBlocks::Boxes::add(const Box3d& box)
{
    for (std::size_t a = 0; a < 3; ++a) {
        min[a].push_back(box.min[a]);
        max[a].push_back(box.max[a]);
    }
}

PointBlocks::PointBlocks(const ChunkPositions& positions, const Node& node, const Grid& grid)
{
    const std::size_t points = positions.size();
    std::size_t level_end = 0, level = 0;
    Box3d group;
    std::size_t in_group = 0;
    const auto end_group = [&] {
        groups.add(group);
        group = Box3d();
        in_group = 0;
    };
    for (std::size_t begin = 0; begin < points;) {
        while (level_end <= begin) {
            if (in_group) end_group();
            level_end = level < node.level_points.size() ? level_end + node.level_points[level++] : points;
        }
        const std::size_t end = std::min({begin + block_points, level_end, points});
        Box3i box;
        for (std::size_t i = begin; i < end; ++i) box.extend(positions.grid(i));
        const Box3d source = grid.to_source(box);
        if (in_group == 0) group_first.push_back(static_cast<std::uint32_t>(blocks.size()));
        blocks.add(source);
        first.push_back(static_cast<std::uint32_t>(begin));
        group.extend(source);
        if (++in_group == group_blocks) end_group();
        begin = end;
    }
    if (in_group) end_group();
    first.push_back(static_cast<std::uint32_t>(points));
    group_first.push_back(static_cast<std::uint32_t>(blocks.size()));
}

std::size_t PointBlocks::bytes() const
{
    return (blocks.size() + groups.size()) * (6 * sizeof(double) + sizeof(std::uint32_t)) + sizeof *this;
}

std::shared_ptr<const PointBlocks> BlockCache::get(NodeId node, const Tree& tree, const ChunkPositions& positions)
{
    {
        const std::lock_guard lock(mutex_);
        const auto place = places_.find(node);
        if (place != places_.end()) {
            used_.splice(used_.begin(), used_, place->second);
            return place->second->second;
        }
    }
    auto made = std::make_shared<const PointBlocks>(positions, tree.node(node), tree.info().grid);
    const std::lock_guard lock(mutex_);
    if (places_.count(node)) return made;  // another thread was quicker; its blocks are the same
    used_.emplace_front(node, made);
    places_[node] = used_.begin();
    bytes_ += made->bytes();
    while (bytes_ > capacity_ && used_.size() > 1) {
        bytes_ -= used_.back().second->bytes();
        places_.erase(used_.back().first);
        used_.pop_back();
    }
    return made;
}

}  // namespace pcm
