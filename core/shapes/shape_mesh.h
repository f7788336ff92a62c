// Shapes as flat faces, for drawings.
#pragma once

#include "pcm/shapes/bounds.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

// Counter-clockwise as seen from outside; a triangle repeats its last corner.
using MeshFace = std::array<Vec3d, 4>;

struct MeshOptions {
    double chord = 0;   // largest distance of a face from the surface, source units; 0: radius / 100, of
                        // spheres and tori, which bend both ways, radius / 50
    bool arcs = false;  // cylinders and cones: only the arc that is bounded, without caps
};

// The faces of a cylinder, cone, sphere or torus, in source coordinates, all corners on its surface. Closed, with caps:
// neighbours share corners to the bit. A torus whose arc is not a whole circle ends there with caps. None where the
// length is not known, and of a plane. Throws Error(invalid_argument) for more than 1,000,000 faces.
void mesh_shape(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const FaceVisitor& visit);

// Lines in space that show a shape without its faces: rims and straight lines of a cylinder or cone, three great
// circles of a sphere, circles of a torus. All corners are on the surface. Circles across the z axis are not among
// them.
struct ShapeLines {
    struct Line {
        std::vector<Vec3d> corners;
        bool closed;
    };
    struct Circle {
        Vec3d centre;
        double radius;
    };
    std::vector<Line> lines;
    std::vector<Circle> circles;  // whole ones across the z axis, exactly
};
// Throws as mesh_shape() does.
ShapeLines lines_of(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options);

// Triangles between the corners of a simple polygon in space that is seen along `normal` turning counter-clockwise, by
// clipping ears: places of corners. None for a polygon that crosses itself or has a corner twice. Takes time by the
// square of the number of corners.
std::vector<std::array<std::uint32_t, 3>> triangulate_outline(const std::vector<Vec3d>& outline, const Vec3d& normal);

}  // namespace pcm
