// Points as they are computed with: relative to their middle, in units of their extent, in random order.
#pragma once

#include "pcm/fit/fit_points.h"
#include "pcm/fit/shape_fit.h"

#include <cstdint>
#include <vector>

namespace pcm {

// Between source coordinates and those relative to `middle`, in units of `unit`.
Shape scaled(Shape shape, const Vec3d& middle, double unit);
Shape unscaled(Shape shape, const Vec3d& middle, double unit);

struct WorkingPoints {
    Vec3d middle{};   // source coordinates
    double unit = 1;  // source units per working unit; a power of two, so that scaling costs no digits
    std::vector<double> x, y, z, nx, ny, nz;
    std::vector<std::uint32_t> index;  // of the points that were given

    std::size_t size() const { return x.size(); }
    bool has_normals() const { return !nx.empty(); }
    Vec3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    Vec3d normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
    Shape to_source(const Shape& shape) const { return unscaled(shape, middle, unit); }
    Shape to_working(const Shape& shape) const { return scaled(shape, middle, unit); }
};

// Whether points can determine any shape of a kind. none: they may.
FitIssue obvious_issue(const FitPoints& points, ShapeKind kind, std::size_t parameters);

// Of points without an obvious issue.
WorkingPoints working_points(const FitPoints& points, std::uint64_t seed);

}  // namespace pcm
