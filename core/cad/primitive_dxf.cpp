// Primitives as DXF.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/dxf_file.h"
#include "pcm/cad/layer_names.h"
#include "pcm/shapes/shape_mesh.h"

#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t most_corners = 20000;  // of an outline that gets faces, which take time by their square

DxfUnit dxf_unit(CadUnit unit)
{
    switch (unit) {
        case CadUnit::none:
            return DxfUnit::none;
        case CadUnit::metres:
            return DxfUnit::metres;
        case CadUnit::millimetres:
            return DxfUnit::millimetres;
        case CadUnit::centimetres:
            return DxfUnit::centimetres;
        case CadUnit::feet:
            return DxfUnit::feet;
        case CadUnit::inches:
            break;
    }
    return DxfUnit::inches;
}

// By a box around all of the primitive.
void extend(Box3d& extent, const Primitive& primitive)
{
    const Shape& shape = primitive.fit.shape;
    const auto around = [&](const Vec3d& centre, double radius) {
        extent.extend(centre - Vec3d{radius, radius, radius});
        extent.extend(centre + Vec3d{radius, radius, radius});
    };
    if (shape.kind == ShapeKind::plane)
        for (const Vec3d& corner : primitive.bounds.outline) extent.extend(corner);
    if (shape.kind == ShapeKind::sphere) around(shape.point, shape.radius);
    if (shape.kind == ShapeKind::torus) around(shape.point, shape.radius + shape.second);
    if (shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone)
        for (const double h : {primitive.bounds.from, primitive.bounds.to})
            around(shape.point + h * shape.axis,
                   shape.kind == ShapeKind::cone ? h * std::tan(shape.second) : shape.radius);
}

// False where there are no faces.
bool draw_plane(DxfFile& dxf, const std::string& layer, const Primitive& primitive)
{
    const std::vector<Vec3d>& outline = primitive.bounds.outline;
    dxf.polyline(layer, outline, true);
    const auto triangles = outline.size() > most_corners ? std::vector<std::array<std::uint32_t, 3>>{}
                                                         : triangulate_outline(outline, primitive.fit.shape.axis);
    for (const auto& t : triangles) dxf.face(layer, outline[t[0]], outline[t[1]], outline[t[2]], outline[t[2]]);
    return !triangles.empty();
}

// The axis of a cylinder or cone from end to end, of a torus through its tube's middle, and lines on the surface. Some
// programs show no faces, and ignore the axes in which DXF gives circles: only those across z are circles.
void draw_lines(DxfFile& dxf, const std::string& layer, const Primitive& primitive, const MeshOptions& options)
{
    const Shape& shape = primitive.fit.shape;
    const ShapeBounds& bounds = primitive.bounds;
    if (shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone)
        dxf.line(layer, shape.point + bounds.from * shape.axis, shape.point + bounds.to * shape.axis);
    if (shape.kind == ShapeKind::torus)
        dxf.line(layer, shape.point - shape.second * shape.axis, shape.point + shape.second * shape.axis);
    const ShapeLines found = lines_of(shape, bounds, options);
    for (const ShapeLines::Line& line : found.lines) dxf.polyline(layer, line.corners, line.closed);
    for (const ShapeLines::Circle& circle : found.circles) dxf.circle(layer, circle.centre, {0, 0, 1}, circle.radius);
}

}  // namespace

void write_drawing(const std::filesystem::path& file, DrawingList& list, const CadOptions& options)
{
    const std::vector<std::string> layers = layer_names(list.names());
    std::vector<DxfLayer> table;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Rgb& colour = list.shown[i]->colour;
        table.push_back({layers[i], nearest_colour_index(colour), colour});
    }
    Box3d extent;
    for (const Primitive* primitive : list.shown) extend(extent, *primitive);
    DxfFile dxf(file, table, {dxf_unit(options.unit), extent});
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Primitive& primitive = *list.shown[i];
        if (primitive.fit.shape.kind == ShapeKind::plane) {
            if (!draw_plane(dxf, layers[i], primitive))
                list.notes.push_back("'" + primitive.name +
                                     "' has a line and no faces: its outline crosses itself, or has more than 20,000 "
                                     "corners");
            continue;
        }
        const MeshOptions mesh{options.chord, options.arcs};
        mesh_shape(primitive.fit.shape, primitive.bounds, mesh,
                   [&](const MeshFace& face) { dxf.face(layers[i], face[0], face[1], face[2], face[3]); });
        draw_lines(dxf, layers[i], primitive, mesh);
    }
    dxf.finish();
}

}  // namespace pcm
