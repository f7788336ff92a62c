// Two directions across an axis: coordinates about it, and angles.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstddef>

namespace pcm {

// Unit vectors, right-handed: u x v is the axis. The same axis gives the same frame.
struct AxisFrame {
    Vec3d u{}, v{}, axis{};

    explicit AxisFrame(const Vec3d& unit_axis) : axis(unit_axis)
    {
        std::size_t least = 0;
        for (std::size_t a = 1; a < 3; ++a)
            if (std::fabs(axis[a]) < std::fabs(axis[least])) least = a;
        Vec3d other{};
        other[least] = 1;
        u = normalised(cross(other, axis));
        v = cross(axis, u);
    }
    // The unit vector at an angle, radians counter-clockwise about the axis from u.
    Vec3d at(double angle) const { return std::cos(angle) * u + std::sin(angle) * v; }
    // The angle of the part of d across the axis, -pi to pi.
    double angle_of(const Vec3d& d) const { return std::atan2(dot(d, v), dot(d, u)); }
};

}  // namespace pcm
