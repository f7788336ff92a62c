// Those of a shape's points that its bounds depend on, while the others are streamed past.
#pragma once

#include "pcm/cloud/numbers.h"
#include "pcm/cloud/vector.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/shape.h"

#include <array>
#include <cstddef>
#include <vector>

namespace pcm {

// bounds_of() the kept points is bounds_of() all points that were added, to a billionth of their extent. Kept are, for
// a plane, the corners of the convex hull; for other shapes, the two ends of the length and, for each 5 degrees about
// the axis, the first and the last point. Not enough for a concave outline. One object by one thread.
class ExtremePoints {
public:
    // `shape` must not have an apex; `middle`: a place near the points, source coordinates.
    ExtremePoints(const Shape& shape, const Vec3d& middle);

    void add(const Vec3d& p);              // source coordinates
    void add(const ExtremePoints& other);  // `other` has the same shape and middle
    std::vector<Vec3d> points() const;     // source coordinates

private:
    static constexpr std::size_t sectors = 72;
    // The points of minimum and maximum value.
    struct Ends {
        double least = infinity, largest = -infinity;
        Vec3d at_least{}, at_largest{};
        void add(double value, const Vec3d& p);
    };
    void keep_hull();

    const ShapeTraits* traits_;
    Vec3d point_{}, middle_{};
    AxisFrame frame_;
    std::vector<Vec3d> hull_;  // and points since it was computed
    std::size_t most_ = 128;   // size of `hull_` at which it is computed again
    Ends along_;
    std::vector<Ends> around_;  // one per sector
};

}  // namespace pcm
