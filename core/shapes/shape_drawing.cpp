#include "pcm/shapes/shape_drawing.h"

namespace pcm {

void draw_faces(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeDrawing& drawing)
{
    mesh_shape(shape, bounds, options, [&](const MeshFace& face) { drawing.face(face); });
}

void draw_lines(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeDrawing& drawing)
{
    const ShapeLines found = lines_of(shape, bounds, options);
    for (const ShapeLines::Line& line : found.lines) drawing.polyline(line.corners, line.closed);
    for (const ShapeLines::Circle& circle : found.circles) drawing.circle(circle.centre, circle.radius);
}

std::string draw_along_axis(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options,
                            ShapeDrawing& drawing)
{
    draw_faces(shape, bounds, options, drawing);
    drawing.line(shape.point + bounds.from * shape.axis, shape.point + bounds.to * shape.axis);
    draw_lines(shape, bounds, options, drawing);
    return {};
}

}  // namespace pcm
