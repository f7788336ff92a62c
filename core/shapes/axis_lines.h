// Circles and lines of a surface that turns about an axis, for the screen.
#pragma once

#include "pcm/shapes/axis_bounds.h"
#include "pcm/shapes/shape_lines.h"

#include <vector>

namespace pcm::shapes {

inline constexpr int lines_around = 8;  // per whole circle

// Two directions across the axis, perpendicular to each other.
struct LineFrame {
    Vec3d zero{}, quarter{};

    Vec3d at(double angle) const;
};
LineFrame line_frame(const Vec3d& axis, const Vec3d& zero);  // `zero` of any length; short: not known

struct Arc {
    double begin = 0, end = 2 * pi;

    bool whole() const { return end - begin >= 2 * pi * (1 - 1e-12); }
    // Equally spaced angles; the ends of an arc are among them.
    std::vector<double> angles(int around) const;
};

ShapeLine circle(const Vec3d& centre, const LineFrame& frame, double radius, const Arc& arc,
                 const ShapeLineOptions& options);

// Circles at both ends and in the middle, lines along them, the axis.
std::vector<ShapeLine> lines_along_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius,
                                        const ShapeLineOptions& options);

}  // namespace pcm::shapes
