// A bounded shape as a solid or a trimmed face of a CAD program.
#pragma once

#include "pcm/cloud/vector.h"

#include <vector>

namespace pcm {

// Takes one shape. Lengths are in source units, axes are unit vectors, angles are in radians.
class ShapeSolids {
public:
    virtual ~ShapeSolids() = default;

    // The part of a plane within a polygon: corners in order, counter-clockwise as seen from the tip of the normal.
    virtual void face(const Vec3d& point, const Vec3d& normal, const std::vector<Vec3d>& corners) = 0;
    // Circles of these radii at `base` and, `length` along the axis, at the other end, which may be points, and what is
    // between them.
    virtual void frustum(const Vec3d& base, const Vec3d& axis, double radius, double other_radius, double length) = 0;
    virtual void ball(const Vec3d& centre, double radius) = 0;
    // A tube along an arc about the axis that begins in the direction of `zero`, a unit vector across it.
    virtual void ring(const Vec3d& centre, const Vec3d& axis, const Vec3d& zero, double radius, double tube_radius,
                      double arc) = 0;
};

}  // namespace pcm
