// A shape as a part of a pipe: the centre line of a cylinder or of an arc of a torus, and its two ends.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <optional>

namespace pcm {

// An end of a centre line.
struct TubeEnd {
    Vec3d place{};  // source coordinates
    Vec3d out{};    // unit tangent of the centre line that points out of the part
};

// Lengths are in source units, errors are standard deviations (ShapeErrors).
struct Tube {
    double radius = 0, radius_error = 0;  // across the centre line
    std::array<TubeEnd, 2> ends;
    double bend = 0;         // radius of the circle that the centre line follows; 0: it is straight
    Vec3d centre{}, axis{};  // the circle's; counter-clockwise about `axis` from the first end to the second
    double arc = 0;          // radians from the first end to the second; 0: it is straight
    double place_error = 0;  // across the centre line, at its ends
    double angle_error = 0;  // error of `out` and `axis`, radians

    bool is_straight() const { return bend == 0; }
};

struct Shape;
struct ShapeBounds;
struct ShapeErrors;
// For kinds that cannot be a part of a pipe.
inline std::optional<Tube> no_tube(const Shape&, const ShapeBounds&, const ShapeErrors&) { return {}; }

}  // namespace pcm
