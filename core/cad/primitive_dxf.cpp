// Primitives as DXF.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/dxf_file.h"
#include "pcm/cad/layer_names.h"
#include "pcm/cad/shape_mesh.h"
#include "pcm/fit/axis_frame.h"

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

// A circle about the axis, or the part of it that is bounded.
void draw_circle(DxfFile& dxf, const std::string& layer, const Primitive& primitive, double h, double radius, bool part)
{
    const Shape& shape = primitive.fit.shape;
    const ShapeBounds& bounds = primitive.bounds;
    const Vec3d centre = shape.point + h * shape.axis;
    if (!part || bounds.zero == Vec3d{}) return dxf.circle(layer, centre, shape.axis, radius);
    const Vec3d from = std::cos(bounds.begin) * bounds.zero + std::sin(bounds.begin) * cross(shape.axis, bounds.zero);
    dxf.arc(layer, centre, shape.axis, radius, from, bounds.end - bounds.begin);
}

void draw_lines(DxfFile& dxf, const std::string& layer, const Primitive& primitive, bool arcs)
{
    const Shape& shape = primitive.fit.shape;
    const ShapeBounds& bounds = primitive.bounds;
    switch (shape.kind) {
        case ShapeKind::plane:
            return;
        case ShapeKind::sphere:
            for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
                dxf.circle(layer, shape.point, axis, shape.radius);
            return;
        case ShapeKind::cylinder:
        case ShapeKind::cone:
            dxf.line(layer, shape.point + bounds.from * shape.axis, shape.point + bounds.to * shape.axis);
            for (const double h : {bounds.from, bounds.to}) {
                const double radius = shape.kind == ShapeKind::cone ? h * std::tan(shape.second) : shape.radius;
                if (radius > 0) draw_circle(dxf, layer, primitive, h, radius, arcs);
            }
            return;
        case ShapeKind::torus:
            break;
    }
    dxf.line(layer, shape.point - shape.second * shape.axis, shape.point + shape.second * shape.axis);
    draw_circle(dxf, layer, primitive, 0, shape.radius, true);
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
        mesh_shape(primitive.fit.shape, primitive.bounds, {options.chord, options.arcs},
                   [&](const MeshFace& face) { dxf.face(layers[i], face[0], face[1], face[2], face[3]); });
        draw_lines(dxf, layers[i], primitive, options.arcs);
    }
    dxf.finish();
}

}  // namespace pcm
