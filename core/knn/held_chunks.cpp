#include "pcm/knn/held_chunks.h"

#include <algorithm>

namespace pcm {

const HeldChunk& HeldChunks::get(NodeId id)
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

}  // namespace pcm
