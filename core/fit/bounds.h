// The part of a shape that there is: a polygon of a plane, the length of a cylinder, the arc of a torus.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/fit/shape.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

enum class OutlineKind : std::uint8_t {
    box,        // the cloud's box cuts the shape: 3 to 6 corners of a plane, the caps of a cylinder
    rectangle,  // of least area around the inliers
    convex,     // their convex hull
    concave,    // follows gaps that are wider than an edge length
};
std::optional<OutlineKind> outline_kind(const std::string& name);
const char* name_of(OutlineKind kind);

struct ShapeBounds {
    // Of a plane: corners in order, source coordinates, counter-clockwise as seen from the tip of the normal; the last
    // is joined to the first. Empty: not known.
    std::vector<Vec3d> outline;
    // Of a cylinder or cone: places along the axis, relative to Shape::point, source units. From == to: not known.
    double from = 0, to = 0;
    // The arc about the axis (of a torus along its circle) that points cover, radians counter-clockwise about the axis
    // from `zero`, a unit vector across it. The whole circle: 0 to 2 pi.
    Vec3d zero{};
    double begin = 0, end = 2 * pi;

    bool known(ShapeKind kind) const
    {
        return kind == ShapeKind::plane ? !outline.empty()
                                        : kind == ShapeKind::sphere || kind == ShapeKind::torus || from < to;
    }
};

// The part inside of a box. Of a plane that misses the box the outline is empty; cylinders and cones are cut where
// their axis leaves the box (slabs); a cylinder whose axis misses the box is cut by the box's corners projected on it.
ShapeBounds bounds_in_box(const Shape& shape, const Box3d& box);

struct OutlineOptions {
    OutlineKind kind = OutlineKind::rectangle;
    double edge = 0;  // of a concave outline: gaps narrower than this are closed, source units; 0: from the spacing
};

// The part that points cover; source coordinates. `box` is used by OutlineKind::box alone. Throws
// Error(invalid_argument) for no points.
ShapeBounds bounds_of(const Shape& shape, const std::vector<Vec3d>& inliers, const OutlineOptions& options,
                      const Box3d& box = {});

}  // namespace pcm
