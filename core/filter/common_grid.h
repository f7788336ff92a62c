// One grid of positions for several clouds.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// The grid of a cloud, and the box of its positions there.
struct GriddedBox {
    Grid grid;
    Box3i box;  // empty: no points
};

// Positions of one grid as positions of another: q * factor + shift, exact in integers.
struct GridMap {
    Vec3i factor{1, 1, 1}, shift{0, 0, 0};
    Vec3i operator()(const Vec3i& q) const
    {
        return {q[0] * factor[0] + shift[0], q[1] * factor[1] + shift[1], q[2] * factor[2] + shift[2]};
    }
};

struct CommonGrid {
    Grid grid;
    std::size_t like = 0;       // the cloud whose steps and offset it has; the first of several
    std::vector<GridMap> maps;  // map of each cloud to it
};

// The finest of the grids, if the positions of all others are on it too: their steps are multiples of its steps, their
// offsets are whole steps away (each to a millionth of a step), and all positions fit 32 bits. Coordinates are then the
// same numbers but for the rounding of q * scale + offset in double. Nothing where there is no such grid. All steps are
// positive.
std::optional<CommonGrid> common_grid(const std::vector<GriddedBox>& clouds);

}  // namespace pcm
