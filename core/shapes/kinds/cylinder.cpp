// A cylinder: a length of it, and an arc about its axis.
#include "pcm/shapes/axis_bounds.h"
#include "pcm/shapes/axis_lines.h"
#include "pcm/shapes/axis_mesh.h"
#include "pcm/shapes/axis_place.h"
#include "pcm/shapes/command_script.h"
#include "pcm/shapes/fitted_shape.h"
#include "pcm/shapes/outline_area.h"
#include "pcm/shapes/shape_drawing.h"
#include "pcm/shapes/shape_solids.h"
#include "pcm/shapes/tube.h"

#include <cmath>

namespace pcm {
namespace {

constexpr ShapeSize sizes[] = {{&Shape::radius, &ShapeErrors::radius, "radius", "radius", "radius", SizeUnit::length}};

double radius_at(const Shape& shape, double) { return shape.radius; }

double distance(const Shape& shape, const Vec3d& p)
{
    return length(exact_cross(shape.axis, p - shape.point)) - shape.radius;
}

Vec3d normal(const Shape& shape, const Vec3d& p) { return shapes::AxisPlace(shape, p - shape.point).direction(shape); }

Vec3d foot(const Shape& shape, const Vec3d& p) { return shape.point + dot(p - shape.point, shape.axis) * shape.axis; }

void bound_points(const Shape& shape, const std::vector<Vec3d>& points, const OutlineOptions&, ShapeBounds& bounds)
{
    shapes::bound_length(
        shape, points, [&](const Vec3d& d) { return exact_dot(shape.axis, d); }, bounds);
}

void extend(const Shape& shape, const ShapeBounds& bounds, Box3d& box)
{
    shapes::extend_about_axis(shape, bounds, radius_at, box);
}

std::vector<ShapeLine> lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options)
{
    return shapes::lines_along_axis(shape, bounds, radius_at, options);
}

void mesh(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const FaceVisitor& visit)
{
    shapes::mesh_along_axis(shape, bounds, radius_at, options, visit);
}

void mesh_lines(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeLines& found)
{
    shapes::mesh_lines_along_axis(shape, bounds, radius_at, options, found);
}

void script(const Shape& shape, const ShapeBounds& bounds, CommandScript& commands)
{
    const AxisFrame frame(shape.axis);
    commands.coordinate_system(shape.point + bounds.from * shape.axis, frame.u, frame.v);
    commands.line("_.CYLINDER");
    commands.place({});
    commands.lines({CommandScript::decimal(shape.radius), CommandScript::decimal(bounds.to - bounds.from)});
}

void solid(const Shape& shape, const ShapeBounds& bounds, ShapeSolids& solids)
{
    solids.frustum(shape.point + bounds.from * shape.axis, shape.axis, shape.radius, shape.radius,
                   bounds.to - bounds.from);
}

std::optional<Tube> tube(const Shape& shape, const ShapeBounds& bounds, const ShapeErrors& errors)
{
    if (!(bounds.from < bounds.to)) return {};
    Tube tube;
    tube.radius = shape.radius;
    tube.radius_error = errors.radius;
    tube.ends = {{{shape.point + bounds.from * shape.axis, -1 * shape.axis},
                  {shape.point + bounds.to * shape.axis, shape.axis}}};
    tube.place_error = std::hypot(errors.position, errors.angle * (bounds.to - bounds.from) / 2);
    tube.angle_error = errors.angle;
    return tube;
}

}  // namespace

constexpr ShapeTraits cylinder_shape{ShapeKind::cylinder,
                                     "cylinder",
                                     "Cylinder",
                                     "cylinder X Y Z AX AY AZ RADIUS",
                                     5,
                                     {"point", "point of the axis", " through "},
                                     ShapeAxis::revolution,
                                     ShapeExtent::length,
                                     ShapeSizes(sizes),
                                     shapes::no_fault,
                                     distance,
                                     normal,
                                     shapes::own_radius,
                                     foot,
                                     shapes::bound_length_in_box,
                                     bound_points,
                                     extend,
                                     no_area,
                                     lines,
                                     mesh,
                                     mesh_lines,
                                     draw_along_axis,
                                     script,
                                     solid,
                                     tube};

}  // namespace pcm
