// Cylinders along points that are longer than wide: where the search for a pipe starts.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/shapes/shape.h"

#include <optional>
#include <vector>

namespace pcm {

struct AxisLine {
    Vec3d middle{}, axis{};
};

// The principal axis of the points; nothing where their standard deviation along it is less than `elongation` times
// that across it.
std::optional<AxisLine> line_of(const std::vector<Vec3d>& points, double elongation);

// The cylinder along the line whose circle is nearest to the points across it (Kasa 1976); nothing where they determine
// no circle.
std::optional<Shape> cylinder_along(const AxisLine& line, const std::vector<Vec3d>& points);

// Largest distance between two of the points along the axis; that of none is negative infinity.
double extent_along(const Vec3d& axis, const std::vector<Vec3d>& points);

}  // namespace pcm
