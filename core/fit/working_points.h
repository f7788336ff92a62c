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
    std::vector<double> x, y, z;
    std::vector<std::uint32_t> index;  // index among the points that were given
    const FitPoints* given = nullptr;

    std::size_t size() const { return x.size(); }
    bool has_normals() const { return given && given->has_normals(); }
    Vec3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    Vec3d normal(std::size_t i) const { return given->normal(index[i]); }
    Shape to_source(const Shape& shape) const { return unscaled(shape, middle, unit); }
    Shape to_working(const Shape& shape) const { return scaled(shape, middle, unit); }
};

// Where points are.
struct PointSpread {
    Vec3d middle{};     // relative to the points' origin
    double extent = 0;  // the largest coordinate relative to it
    Vec3d across{};     // root mean squares along the main directions, ascending, of coordinates of extent 1
};

// Whether points can determine any shape of a kind. none: they may, and `spread` is set.
FitIssue obvious_issue(const FitPoints& points, ShapeKind kind, std::size_t parameters, PointSpread& spread);

// From points without an obvious issue, which are kept.
WorkingPoints working_points(const FitPoints& points, const PointSpread& spread, std::uint64_t seed);

}  // namespace pcm
