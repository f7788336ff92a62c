// A step of least squares for points that do not fit in memory: their normal equations about a shape.
#pragma once

#include "pcm/fit/shape_fit.h"
#include "pcm/fit/surface_patch.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace pcm {

// Sums over points of distance, its derivatives, and their products. Sums of parts may be added in a fixed order, so
// that the result does not depend on threads. One object by one thread.
class ShapeSums {
public:
    // Distances are measured from `shape`; `middle` is a place near the points, and `extent` about their size, source
    // units. Throws what check(shape) throws.
    ShapeSums(const Shape& shape, const Vec3d& middle, double extent);

    void add(const Vec3d& p);          // source coordinates
    void add(const ShapeSums& other);  // sums of the same shape, middle and extent
    // As if fewer points had been added: those of the other, of which there are fewer.
    void subtract(const ShapeSums& other);

    std::uint64_t points() const { return sums_.inliers; }
    double rms() const;  // root mean square of the distances, source units
    // A Gauss-Newton step; nothing where the points determine none, or it leads to no shape. Where `rms` of the points
    // about the result is larger, half of it (and so on) should be tried: `part` of the step.
    std::optional<Shape> step(double part = 1) const;
    // Errors, condition, rms, verdict, issue and message of `shape` as the result of these points, which are all within
    // `threshold` of it; 0 or infinite: there was none.
    ShapeFit result(double threshold) const;

private:
    Shape shape_;
    Vec3d middle_;
    double extent_;
    SurfacePatch patch_;
    PatchSums sums_;
};

}  // namespace pcm
