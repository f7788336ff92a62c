// Boxes, and the integer grid of positions. All lengths are in source units.
#pragma once

#include "pcm/cloud/vector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pcm {

// Axis-aligned box; empty when min > max on any axis.
struct Box3d {
    Vec3d min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()};
    Vec3d max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              -std::numeric_limits<double>::infinity()};

    bool empty() const { return min[0] > max[0] || min[1] > max[1] || min[2] > max[2]; }
    void extend(const Vec3d& p)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            min[a] = std::min(min[a], p[a]);
            max[a] = std::max(max[a], p[a]);
        }
    }
    void extend(const Box3d& b)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            min[a] = std::min(min[a], b.min[a]);
            max[a] = std::max(max[a], b.max[a]);
        }
    }
    bool contains(const Vec3d& p) const
    {
        return p[0] >= min[0] && p[0] <= max[0] && p[1] >= min[1] && p[1] <= max[1] && p[2] >= min[2] && p[2] <= max[2];
    }
    bool contains(const Box3d& b) const { return !b.empty() && contains(b.min) && contains(b.max); }
    bool intersects(const Box3d& b) const
    {
        return min[0] <= b.max[0] && b.min[0] <= max[0] && min[1] <= b.max[1] && b.min[1] <= max[1] &&
               min[2] <= b.max[2] && b.min[2] <= max[2];
    }
    Vec3d centre() const
    {
        return {min[0] + (max[0] - min[0]) / 2, min[1] + (max[1] - min[1]) / 2, min[2] + (max[2] - min[2]) / 2};
    }
    double extent(std::size_t axis) const { return max[axis] - min[axis]; }
    double diagonal() const { return empty() ? 0.0 : std::hypot(extent(0), extent(1), extent(2)); }
    bool operator==(const Box3d& o) const { return min == o.min && max == o.max; }
};

// Box of grid positions, both ends included; empty when min > max.
struct Box3i {
    Vec3i min{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max(),
              std::numeric_limits<std::int64_t>::max()};
    Vec3i max{std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::min(),
              std::numeric_limits<std::int64_t>::min()};

    bool empty() const { return min[0] > max[0] || min[1] > max[1] || min[2] > max[2]; }
    void extend(const Vec3i& p)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            min[a] = std::min(min[a], p[a]);
            max[a] = std::max(max[a], p[a]);
        }
    }
    void extend(const Box3i& b)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            min[a] = std::min(min[a], b.min[a]);
            max[a] = std::max(max[a], b.max[a]);
        }
    }
    bool contains(const Vec3i& p) const
    {
        return p[0] >= min[0] && p[0] <= max[0] && p[1] >= min[1] && p[1] <= max[1] && p[2] >= min[2] && p[2] <= max[2];
    }
    bool operator==(const Box3i& o) const { return min == o.min && max == o.max; }
};

// Positions are integers q; the source coordinate is q * scale + offset, evaluated in this order in double as the LAS
// specification defines it. The integers, scale and offset of a LAS file are kept bit for bit.
struct Grid {
    Vec3d scale{1, 1, 1};
    Vec3d offset{0, 0, 0};

    double to_source(std::int64_t q, std::size_t axis) const
    {
        return static_cast<double>(q) * scale[axis] + offset[axis];
    }
    Vec3d to_source(const Vec3i& q) const { return {to_source(q[0], 0), to_source(q[1], 1), to_source(q[2], 2)}; }
    Box3d to_source(const Box3i& b) const
    {
        Box3d box;
        if (b.empty()) return box;
        box.min = to_source(b.min);
        box.max = to_source(b.max);
        return box;
    }
    bool operator==(const Grid& o) const { return scale == o.scale && offset == o.offset; }
};

}  // namespace pcm
