// A step of least squares for points that do not fit in memory: their normal equations about a shape.
#pragma once

#include "pcm/fit/shape_fit.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace pcm {

// Sums over points of distance, its derivatives, and their products. Sums of parts may be added in a fixed order, so
// that the result does not depend on threads. One object by one thread.
class ShapeSums {
public:
    // Distances are measured from `shape`; `middle` is a place near the points, and `extent` about their size.
    ShapeSums(const Shape& shape, const Vec3d& middle, double extent);

    void add(const Vec3d& p);  // source coordinates
    void add(const ShapeSums& other);

    std::uint64_t points() const { return points_; }
    double rms() const;
    // A damped Gauss-Newton step; nothing where the points determine none.
    std::optional<Shape> step() const;
    // Errors, condition, rms, verdict, issue and message of `shape` as the result of these points.
    ShapeFit result(double threshold) const;

private:
    static constexpr std::size_t most = 7;
    Shape shape_;
    Vec3d middle_;
    double extent_;
    std::uint64_t points_ = 0;
    double squares_ = 0, squares_error_ = 0;
    std::array<double, most> gradient_{};
    std::array<double, most * most> products_{};
};

}  // namespace pcm
