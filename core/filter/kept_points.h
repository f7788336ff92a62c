// Points that are at least a spacing apart, and whether another one is near to them.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// A hash table of cubes as wide as the spacing. Distances are compared by squares in double: two points are near when
// (dx * dx + dy * dy) + dz * dz < spacing * spacing. One thread.
class KeptPoints {
public:
    // Points are at most 2^42 spacings away from `origin` on every axis.
    KeptPoints(double spacing, const Vec3d& origin);

    void add(const Vec3d& p);
    bool has_near(const Vec3d& p) const;
    const std::vector<Vec3d>& points() const { return points_; }

private:
    using Cube = std::array<std::int64_t, 3>;
    static constexpr std::uint32_t none = 0xffffffffu;

    Cube cube_of(const Vec3d& p) const;
    std::size_t slot(const Cube& cube) const;
    void grow();

    const double square_, side_;
    const Vec3d origin_;
    std::vector<Vec3d> points_;
    std::vector<std::uint32_t> next_, heads_;
};

}  // namespace pcm
