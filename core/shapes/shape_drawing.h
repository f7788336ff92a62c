// What a drawing is made of: a shape puts its parts into one, a file format writes them.
#pragma once

#include "pcm/shapes/shape_mesh.h"

#include <string>
#include <vector>

namespace pcm {

class ShapeDrawing {
public:
    virtual ~ShapeDrawing() = default;
    virtual void line(const Vec3d& from, const Vec3d& to) = 0;
    virtual void polyline(const std::vector<Vec3d>& corners, bool closed) = 0;
    virtual void circle(const Vec3d& centre, double radius) = 0;  // across the z axis
    virtual void face(const MeshFace& corners) = 0;
};

// For rows of shapes/shape_traits.h. They throw what mesh_shape() throws.
void draw_faces(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeDrawing& drawing);
// Some programs show no faces, and ignore the axes in which DXF gives circles: only those across z are circles.
void draw_lines(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeDrawing& drawing);
// Both, and the axis from end to end.
std::string draw_along_axis(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options,
                            ShapeDrawing& drawing);

}  // namespace pcm
