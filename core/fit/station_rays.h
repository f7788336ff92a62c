// The rays of a scanner's stations to the points of a shape.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/shapes/shape.h"

#include <cstdint>
#include <map>
#include <vector>

namespace pcm {

struct PointOnShape {
    Vec3d place{}, normal{};  // in units of the extent, about the middle
    double distance = 0;      // signed, from the shape, in units of the extent
};

struct StationRays {
    std::vector<PointOnShape> points;
    Vec3d direction{};  // unit vector, about that of the rays: the mean normal of the points
    double noise = 0;   // variance of the errors along the rays, square of the extent's unit; 0 from rays_of()
};

// Those of the stations whose points show the direction of their rays (fit.ray_errors.min_mean_normal). `extent`: above
// 0, source units.
std::map<std::uint32_t, StationRays> rays_of(const Shape& shape, const std::vector<PointOfStation>& points,
                                             const Vec3d& middle, double extent);

}  // namespace pcm
