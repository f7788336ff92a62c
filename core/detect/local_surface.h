// The surface around a point: a paraboloid, and the shapes that curve as it does.
#pragma once

#include "pcm/detect/surface_sample.h"
#include "pcm/shapes/shape.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Points of the patches around a place, in turn.
inline constexpr std::array<std::size_t, 3> patch_sizes{24, 96, 384};

// z = c0 + c1 x + c2 y + (xx x^2 + 2 xy x y + yy y^2) / 2 in a frame at a point, z along its normal.
struct LocalSurface {
    Vec3d place{}, x{}, y{}, z{};
    double c0 = 0, c1 = 0, c2 = 0, xx = 0, xy = 0, yy = 0;
    double rms = 0;              // rms distance of the points near it, with the degrees of freedom
    double curvature_error = 0;  // standard deviation of a curvature
    double near = 0;             // share of the points that are near it
    double extent = 0;           // largest distance of a point from the place across the normal
};

// Least squares, twice: the second time of the points up to `threshold` from the first. Nothing for fewer than 8
// points, and where they determine no paraboloid.
std::optional<LocalSurface> fit_local_surface(const SurfaceSample& sample, const std::uint32_t* points,
                                              std::size_t count, double threshold);

// Shapes through the place that have the paraboloid's normal and, as far as its errors say, its curvatures; of the
// given kinds. Relative to the sample's origin.
std::vector<Shape> shapes_like(const LocalSurface& surface, const std::vector<ShapeKind>& kinds);

}  // namespace pcm
