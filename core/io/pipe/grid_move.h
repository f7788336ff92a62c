// Integers on the grid of one file as integers on that of another, without doubles between them.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/io/record_batch.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace pcm {

// From a grid to one that differs by whole steps (grid_steps.h).
class GridMove {
public:
    GridMove(const Grid& from, const Grid& to);

    // Whether positions in `box`, source units, stay within 32 bits.
    bool fits(const Box3d& box) const;
    // Moves the points of a gridded batch, or records. False when one needs more than 32 bits; what was moved is then
    // of no use.
    bool move(PointBatch& batch);
    bool move(RecordBatch& batch);
    // Largest change of a coordinate so far, source units: offsets and products are rounded in double.
    double error() const { return error_; }

private:
    bool move(std::size_t axis, std::byte* integers, std::size_t stride, std::size_t count);

    const Grid from_, to_;
    std::array<std::int64_t, 3> steps_{};
    double error_ = 0;
};

}  // namespace pcm
