// Convex hull of points in a plane's axes.
#pragma once

#include "pcm/cloud/polygon.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/shape.h"

#include <vector>

namespace pcm {

class FlatHull {
public:
    FlatHull(const std::vector<Vec3d>& points, const Shape& plane);

    double area() const;
    // Distance from another hull along the normals of this one's edges; below 0 where they overlap along all of them.
    // Both in the axes of the same plane.
    double gap_to(const FlatHull& other) const;
    // The same of a point, projected to the plane; infinite where the hull has no area.
    double gap_to(const Vec3d& p) const { return gap_to(Vec2d{dot(p - point_, frame_.u), dot(p - point_, frame_.v)}); }

private:
    double gap_to(const Vec2d& p) const;

    struct Side {
        Vec2d corner, outwards;
        double gap_to(const Vec2d& p) const
        {
            return (p[0] - corner[0]) * outwards[0] + (p[1] - corner[1]) * outwards[1];
        }
    };

    Vec3d point_;
    AxisFrame frame_;
    std::vector<Vec2d> corners_;  // counter-clockwise
    std::vector<Side> sides_;     // from each corner to the next one
};

// Width of a convex outline, the minimum distance of two parallel lines that hold it, source units; infinite where
// there is no outline.
double width_of(const std::vector<Vec3d>& outline);

}  // namespace pcm
