// The part of a shape that there is: a polygon of a plane, the length of a cylinder, the arc of a torus.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/shapes/shape.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

enum class OutlineKind : std::uint8_t {
    box,        // the cloud's box cuts the shape: 3 to 6 corners of a plane, the caps of a cylinder
    rectangle,  // the one of least area around the inliers
    convex,     // their convex hull
    concave,    // follows gaps that are wider than an edge length
};
std::optional<OutlineKind> outline_kind(const std::string& name);
const char* name_of(OutlineKind kind);

struct ShapeBounds {
    // Corners of a plane in order, source coordinates, counter-clockwise as seen from the tip of the normal; the last
    // is joined to the first. Empty: not known.
    std::vector<Vec3d> outline;
    // Places along the axis of a cylinder or cone, relative to Shape::point, source units. From == to: not known.
    double from = 0, to = 0;
    // The arc about the axis (of a torus along its circle) that points cover, radians counter-clockwise about the axis
    // from `zero`, a unit vector across it: 0 <= begin < 2 pi, begin < end <= begin + 2 pi. The whole circle: 0 to 2
    // pi.
    Vec3d zero{};
    double begin = 0, end = 2 * pi;

    bool known(ShapeKind kind) const
    {
        const ShapeExtent extent = traits_of(kind).extent;
        return extent == ShapeExtent::outline ? !outline.empty() : extent == ShapeExtent::closed || from < to;
    }
};

// The part inside of a box. A plane that misses the box, or touches it at a corner or an edge, has an empty outline,
// else it has 3 to 6 corners; a plane in a flat box has the box's four. Cylinders and cones are cut where their axis
// leaves the box (slabs); one whose axis misses the box is cut by the box's corners projected on it. A cone begins at
// its apex. An empty box bounds nothing. Throws Error(invalid_argument) for a box that is not finite, and what check()
// throws. Any thread.
ShapeBounds bounds_in_box(const Shape& shape, const Box3d& box);

struct OutlineOptions {
    OutlineKind kind = OutlineKind::rectangle;
    // Gaps of a concave outline narrower than this are closed, source units. 0: three times the median of the longest
    // sides of the triangles between points.
    double edge = 0;
};

// The part that points cover; source coordinates. `box` is used by OutlineKind::box alone, which takes nothing but arcs
// from the points. Corners are right to a billionth of the points' extent. An arc ends at the largest gap between
// points as seen from the axis, where that is wider than 30 degrees and than chance makes it, else it is the whole
// circle. Throws Error(invalid_argument) for no points, points that are not finite, and a plane's points that are all
// on one line or at one place, which have no outline. O(n log n) time, and about 60 bytes per point (concave: 200). Any
// thread.
ShapeBounds bounds_of(const Shape& shape, const std::vector<Vec3d>& inliers, const OutlineOptions& options,
                      const Box3d& box = {});

}  // namespace pcm
