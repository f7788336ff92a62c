// A cone on one side of its apex: a length of it, and an arc about its axis.
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

constexpr ShapeSize sizes[] = {
    {&Shape::second, &ShapeErrors::second, "half_angle", "half angle", "half angle", SizeUnit::angle}};

double radius_at(const Shape& shape, double h) { return h * std::tan(shape.second); }

const char* fault(const Shape& shape)
{
    return shape.second > 0 && shape.second < pi / 2 ? nullptr
                                                     : "half the cone's opening angle is not between 0 and 90 degrees";
}

double distance(const Shape& shape, const Vec3d& p)
{
    const Vec3d d = p - shape.point;
    const shapes::AxisPlace place(shape, d);
    const double c = std::cos(shape.second), s = std::sin(shape.second);
    return place.h * c + place.q * s < 0 ? length(d) : place.q * c - place.h * s;
}

Vec3d normal(const Shape& shape, const Vec3d& p)
{
    const Vec3d d = p - shape.point;
    const shapes::AxisPlace place(shape, d);
    const double c = std::cos(shape.second), s = std::sin(shape.second);
    if (place.h * c + place.q * s < 0 && length(d) > 0) return normalised(d);
    return c * place.direction(shape) - s * shape.axis;
}

double bend(const Shape& shape, const Vec3d& p)
{
    return length(cross(p - shape.point, shape.axis)) / std::cos(shape.second);
}

// By the places on the cone that are nearest to the points.
void bound_points(const Shape& shape, const std::vector<Vec3d>& points, const OutlineOptions&, ShapeBounds& bounds)
{
    const double c = std::cos(shape.second), s = std::sin(shape.second);
    const auto height = [&](const Vec3d& d) {
        return c * (exact_dot(shape.axis, d) * c + length(exact_cross(shape.axis, d)) * s);
    };
    shapes::bound_length(shape, points, height, bounds);
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

// From its base at the wide end towards the apex.
void script(const Shape& shape, const ShapeBounds& bounds, CommandScript& commands)
{
    const AxisFrame frame(-1 * shape.axis);
    commands.coordinate_system(shape.point + bounds.to * shape.axis, frame.u, frame.v);
    commands.line("_.CONE");
    commands.place({});
    commands.line(CommandScript::decimal(bounds.to * std::tan(shape.second)));
    if (bounds.from > 0) commands.lines({"_T", CommandScript::decimal(bounds.from * std::tan(shape.second))});
    commands.line(CommandScript::decimal(bounds.to - bounds.from));
}

void solid(const Shape& shape, const ShapeBounds& bounds, ShapeSolids& solids)
{
    const double slope = std::tan(shape.second);
    solids.frustum(shape.point + bounds.from * shape.axis, shape.axis, bounds.from * slope, bounds.to * slope,
                   bounds.to - bounds.from);
}

}  // namespace

constexpr ShapeTraits cone_shape{ShapeKind::cone,
                                 "cone",
                                 "Cone",
                                 "cone X Y Z AX AY AZ DEGREES",
                                 6,
                                 {"apex", "apex", " with its apex at "},
                                 ShapeAxis::revolution,
                                 ShapeExtent::length_from_apex,
                                 ShapeSizes(sizes),
                                 fault,
                                 distance,
                                 normal,
                                 bend,
                                 shapes::own_place,
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
                                 no_tube};

}  // namespace pcm
