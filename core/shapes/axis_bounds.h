// What bounds the part of a shape with an axis: lengths along it and arcs about it.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/numbers.h"
#include "pcm/shapes/bounds.h"

#include <algorithm>
#include <vector>

namespace pcm::shapes {

// Distance of the surface from the axis at a place along it.
using RadiusAt = double (*)(const Shape& shape, double h);

// Sets from and to, where there is a length between them; of a shape with an apex none before it.
void set_length(const Shape& shape, double from, double to, ShapeBounds& bounds);
void bound_length_in_box(const Shape& shape, const Box3d& box, ShapeBounds& bounds);

// From the least to the greatest height(p - Shape::point) of the points.
template <class Height>
void bound_length(const Shape& shape, const std::vector<Vec3d>& points, const Height& height, ShapeBounds& bounds)
{
    double from = infinity, to = -infinity;
    for (const Vec3d& p : points) {
        const double h = height(p - shape.point);
        from = std::min(from, h);
        to = std::max(to, h);
    }
    set_length(shape, from, to, bounds);
}

// All but the largest gap between neighbours about the axis, where that is too wide to be one between points.
void bound_arc(const Shape& shape, const std::vector<Vec3d>& inliers, ShapeBounds& bounds);

// For closed shapes, which nothing bounds but an arc.
inline void closed_in_box(const Shape&, const Box3d&, ShapeBounds&) {}
inline void closed_points(const Shape&, const std::vector<Vec3d>&, const OutlineOptions&, ShapeBounds&) {}

void extend_around(const Vec3d& centre, double radius, Box3d& box);                                  // adds a cube
void extend_about_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius, Box3d& box);  // adds both ends

}  // namespace pcm::shapes
