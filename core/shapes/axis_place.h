// Places relative to the axis of a cylinder, cone or torus.
#pragma once

#include "pcm/cloud/exact_products.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/shape.h"

namespace pcm::shapes {

// d = p - point in coordinates of the axis: h along it, q across it.
struct AxisPlace {
    Vec3d across{};
    double h = 0, q = 0;

    AxisPlace(const Shape& shape, const Vec3d& d) : h(exact_dot(shape.axis, d)), q(length(exact_cross(shape.axis, d)))
    {
        across = d - h * shape.axis;
    }
    // The unit vector across the axis; any one for a place on it.
    Vec3d direction(const Shape& shape) const
    {
        const double away = length(across);
        return away > 0 ? across / away : AxisFrame(shape.axis).u;
    }
};

// For kinds whose rows need no more.
inline const char* no_fault(const Shape&) { return nullptr; }
inline Vec3d own_place(const Shape& shape, const Vec3d&) { return shape.point; }
inline double own_radius(const Shape& shape, const Vec3d&) { return shape.radius; }

}  // namespace pcm::shapes
