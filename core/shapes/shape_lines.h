// A bounded shape as lines: its outline or circles, lines of its surface, and its axis.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/shapes/bounds.h"
#include "pcm/shapes/shape.h"

#include <vector>

namespace pcm {

struct ShapeLine {
    std::vector<Vec3d> points;  // joined by segments, source coordinates
    bool closed = false;        // the last point is joined to the first
    bool is_axis = false;       // not on the surface: an axis, the circle that a torus' tube follows, a plane's normal
};

struct ShapeLineOptions {
    double chord = 0;  // largest distance of a segment from its circle, source units; 0: the circle's radius / 500
};

// Planes: the outline, and a short normal at its middle. Cylinders and cones: circles at both ends and in the middle
// (arcs, where the bounds have them), lines along them, the axis. Spheres: meridians and parallels. Tori: circles along
// and across the tube. Empty for bounds that are not known, and for a shape or bounds with numbers that are not finite.
// Circles have from 8 to 720 segments.
std::vector<ShapeLine> shape_lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options = {});

// Around the bounded shape; about 1 % of its size larger than the curved ones. Empty where there are no lines.
Box3d box_of(const Shape& shape, const ShapeBounds& bounds);

}  // namespace pcm
