// A plane: a polygon of it, drawn by its outline and triangles.
#include "pcm/cloud/exact_products.h"
#include "pcm/cloud/numbers.h"
#include "pcm/shapes/axis_place.h"
#include "pcm/shapes/bounds.h"
#include "pcm/shapes/command_script.h"
#include "pcm/shapes/outline_area.h"
#include "pcm/shapes/plane_outline.h"
#include "pcm/shapes/shape_drawing.h"
#include "pcm/shapes/shape_lines.h"
#include "pcm/shapes/shape_mesh.h"
#include "pcm/shapes/shape_solids.h"
#include "pcm/shapes/tube.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr double normal_length = 0.1;        // share of the outline's diagonal
constexpr std::size_t most_corners = 20000;  // in an outline that gets faces, which take time by their square

double distance(const Shape& shape, const Vec3d& p) { return exact_dot(shape.axis, p - shape.point); }

Vec3d normal(const Shape& shape, const Vec3d&) { return shape.axis; }

double bend(const Shape&, const Vec3d&) { return infinity; }

Vec3d foot(const Shape& shape, const Vec3d& p) { return p - dot(p - shape.point, shape.axis) * shape.axis; }

void bound_in_box(const Shape& shape, const Box3d& box, ShapeBounds& bounds)
{
    bounds.outline = shapes::plane_in_box(shape, box);
}

void bound_points(const Shape& shape, const std::vector<Vec3d>& points, const OutlineOptions& options,
                  ShapeBounds& bounds)
{
    bounds.outline = shapes::outline_of_points(shape, points, options);
}

void extend(const Shape&, const ShapeBounds& bounds, Box3d& box)
{
    for (const Vec3d& corner : bounds.outline) box.extend(corner);
}

OutlineArea area(const ShapeBounds& bounds, std::uint64_t points) { return outline_area(bounds.outline, points); }

// The outline, and a short normal at its middle.
std::vector<ShapeLine> lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions&)
{
    Box3d box;
    for (const Vec3d& corner : bounds.outline) box.extend(corner);
    const Vec3d inside = box.centre();
    const Vec3d middle = inside - dot(shape.axis, inside - shape.point) * shape.axis;
    return {{bounds.outline, true, false},
            {{middle, middle + (normal_length * box.diagonal()) * shape.axis}, false, true}};
}

void no_mesh(const Shape&, const ShapeBounds&, const MeshOptions&, const FaceVisitor&) {}
void no_mesh_lines(const Shape&, const ShapeBounds&, const MeshOptions&, ShapeLines&) {}

std::string draw(const Shape& shape, const ShapeBounds& bounds, const MeshOptions&, ShapeDrawing& drawing)
{
    const std::vector<Vec3d>& outline = bounds.outline;
    drawing.polyline(outline, true);
    const auto triangles = outline.size() > most_corners ? std::vector<std::array<std::uint32_t, 3>>{}
                                                         : triangulate_outline(outline, shape.axis);
    for (const auto& t : triangles) drawing.face({outline[t[0]], outline[t[1]], outline[t[2]], outline[t[2]]});
    return triangles.empty() ? "its outline crosses itself, or has more than 20,000 corners" : "";
}

void script(const Shape&, const ShapeBounds& bounds, CommandScript& commands)
{
    const Vec3d& origin = bounds.outline.front();
    commands.coordinate_system(origin, {1, 0, 0}, {0, 1, 0});
    commands.line("_.3DPOLY");
    for (const Vec3d& corner : bounds.outline) commands.place(corner - origin);
    commands.line("_C");
}

void solid(const Shape& shape, const ShapeBounds& bounds, ShapeSolids& solids)
{
    solids.face(shape.point, shape.axis, bounds.outline);
}

}  // namespace

constexpr ShapeTraits plane_shape{ShapeKind::plane,
                                  "plane",
                                  "Plane",
                                  "plane X Y Z NX NY NZ",
                                  3,
                                  {"point", "point", " through "},
                                  ShapeAxis::normal,
                                  ShapeExtent::outline,
                                  ShapeSizes(),
                                  shapes::no_fault,
                                  distance,
                                  normal,
                                  bend,
                                  foot,
                                  bound_in_box,
                                  bound_points,
                                  extend,
                                  area,
                                  lines,
                                  no_mesh,
                                  no_mesh_lines,
                                  draw,
                                  script,
                                  solid,
                                  no_tube};

}  // namespace pcm
