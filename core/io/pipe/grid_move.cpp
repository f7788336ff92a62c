#include "pcm/io/pipe/grid_move.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm {

GridMove::GridMove(const Grid& from, const Grid& to) : from_(from), to_(to)
{
    for (std::size_t a = 0; a < 3; ++a) steps_[a] = std::llround((from.offset[a] - to.offset[a]) / to.scale[a]);
}

bool GridMove::fits(const Box3d& box) const
{
    constexpr double most = std::numeric_limits<std::int32_t>::max() - 1;
    for (std::size_t a = 0; a < 3 && !box.empty(); ++a)
        for (const double end : {box.min[a], box.max[a]})
            if (!(std::fabs((end - to_.offset[a]) / to_.scale[a]) <= most)) return false;
    return true;
}

// A block at a time, in loops that have vectors.
bool GridMove::move(std::size_t axis, std::byte* integers, std::size_t stride, std::size_t count)
{
    constexpr std::size_t block = 256;
    const double scale = to_.scale[axis], before = from_.offset[axis], after = to_.offset[axis];
    const std::int64_t steps = steps_[axis];
    std::array<std::int32_t, block> from, to;
    std::int64_t beyond = 0;
    double error = error_;
    for (std::size_t first = 0; first < count; first += block, integers += block * stride) {
        const std::size_t n = std::min(block, count - first);
        for (std::size_t i = 0; i < n; ++i) std::memcpy(&from[i], integers + i * stride, sizeof from[i]);
        for (std::size_t i = 0; i < n; ++i) {
            const std::int64_t q = from[i] + steps;
            to[i] = static_cast<std::int32_t>(q);
            beyond |= q ^ to[i];
        }
        for (std::size_t i = 0; i < n; ++i) {
            const double change = (static_cast<double>(to[i]) * scale + after) - (from[i] * scale + before);
            error = std::max(error, std::fabs(change));
        }
        for (std::size_t i = 0; i < n; ++i) std::memcpy(integers + i * stride, &to[i], sizeof to[i]);
    }
    if (beyond) return false;
    error_ = error;
    return true;
}

bool GridMove::move(PointBatch& batch)
{
    bool fit = true;
    for (std::size_t a = 0; a < 3; ++a)
        fit = move(a, reinterpret_cast<std::byte*>(batch.grid_xyz[a].data()), sizeof(std::int32_t), batch.size) && fit;
    return fit;
}

bool GridMove::move(RecordBatch& batch)
{
    bool fit = true;
    for (std::size_t a = 0; a < 3; ++a)
        fit = move(a, batch.bytes.data() + a * sizeof(std::int32_t), batch.stride, batch.size) && fit;
    return fit;
}

}  // namespace pcm
