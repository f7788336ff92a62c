// A torus: an arc of it along the circle that its tube follows.
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
#include <utility>

namespace pcm {
namespace {

constexpr ShapeSize sizes[] = {
    {&Shape::radius, &ShapeErrors::radius, "radius", "radius", "radius", SizeUnit::length},
    {&Shape::second, &ShapeErrors::second, "tube_radius", "tube", "tube's radius", SizeUnit::length}};

const char* fault(const Shape& shape)
{
    return shape.second > 0 && shape.second < shape.radius
               ? nullptr
               : "the radius of the torus' tube is not between 0 and that of its circle";
}

double distance(const Shape& shape, const Vec3d& p)
{
    const shapes::AxisPlace place(shape, p - shape.point);
    return std::hypot(place.q - shape.radius, place.h) - shape.second;
}

Vec3d normal(const Shape& shape, const Vec3d& p)
{
    const shapes::AxisPlace place(shape, p - shape.point);
    const Vec3d across = place.direction(shape);
    const double out = place.q - shape.radius, away = std::hypot(out, place.h);
    return away > 0 ? (out / away) * across + (place.h / away) * shape.axis : across;
}

double tube_radius(const Shape& shape, const Vec3d&) { return shape.second; }

void extend(const Shape& shape, const ShapeBounds&, Box3d& box)
{
    shapes::extend_around(shape.point, shape.radius + shape.second, box);
}

// Circles along and across the tube, and the circle that it follows.
std::vector<ShapeLine> lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options)
{
    const shapes::LineFrame frame = shapes::line_frame(shape.axis, bounds.zero);
    const shapes::Arc arc{bounds.begin, bounds.end};
    std::vector<ShapeLine> found;
    for (const double angle : shapes::Arc{}.angles(4))
        found.push_back(shapes::circle(shape.point + (shape.second * std::sin(angle)) * shape.axis, frame,
                                       shape.radius + shape.second * std::cos(angle), arc, options));
    for (const double angle : arc.angles(shapes::lines_around)) {
        const Vec3d out = frame.at(angle);
        found.push_back(shapes::circle(shape.point + shape.radius * out, {out, shape.axis}, shape.second, {}, options));
    }
    found.push_back(shapes::circle(shape.point, frame, shape.radius, arc, options));
    found.back().is_axis = true;
    return found;
}

double chord_of(const Shape& shape, const MeshOptions& options)
{
    return options.chord > 0 ? options.chord : shape.second / 50;
}

void mesh(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const FaceVisitor& visit)
{
    const double chord = chord_of(shape, options);
    const shapes::Fan fan(shape, bounds, false, shape.radius + shape.second, chord / 2);
    const std::size_t tube = shapes::segments(shape.second, chord / 2, 2 * pi);
    shapes::check_faces(fan.count(), tube, chord);
    const auto at = [&](std::size_t i, std::size_t j) {
        const double turn = 2 * pi * static_cast<double>(j % tube) / static_cast<double>(tube);
        return shape.point + ((shape.radius + shape.second * std::cos(turn)) * fan.at(i) +
                              shape.second * std::sin(turn) * shape.axis);
    };
    for (std::size_t i = 0; i < fan.count(); ++i)
        for (std::size_t j = 0; j < tube; ++j) visit({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    if (fan.whole()) return;
    for (const bool last : {false, true}) {
        std::vector<Vec3d> corners;
        for (std::size_t j = 0; j < tube; ++j) corners.push_back(at(last ? fan.count() : 0, j));
        shapes::cap(corners, last, visit);
    }
}

void mesh_lines(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeLines& found)
{
    const double chord = chord_of(shape, options);
    const shapes::Fan fan(shape, bounds, false, shape.radius + shape.second, chord / 2);
    const std::size_t tube = shapes::segments(shape.second, chord / 2, 2 * pi);
    shapes::check_faces(fan.count(), tube, chord);
    for (const auto& [out, up] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}) {
        std::vector<Vec3d> corners;
        for (std::size_t i = 0; i < fan.count() + (fan.whole() ? 0 : 1); ++i)
            corners.push_back(shape.point +
                              ((shape.radius + out * shape.second) * fan.at(i) + up * shape.second * shape.axis));
        found.lines.push_back({std::move(corners), fan.whole()});
    }
    for (const std::size_t i : shapes::quarters(fan.count(), fan.whole()))
        found.lines.push_back(
            shapes::ring(shape.point + shape.radius * fan.at(i), fan.at(i), shape.axis, shape.second, tube));
}

std::string draw(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeDrawing& drawing)
{
    draw_faces(shape, bounds, options, drawing);
    drawing.line(shape.point - shape.second * shape.axis, shape.point + shape.second * shape.axis);
    draw_lines(shape, bounds, options, drawing);
    return {};
}

// The direction from the axis at an angle of the arc.
Vec3d arc_direction(const Shape& shape, const ShapeBounds& bounds, double angle)
{
    const Vec3d zero = normalised(bounds.zero - dot(bounds.zero, shape.axis) * shape.axis);
    return std::cos(angle) * zero + std::sin(angle) * cross(shape.axis, zero);
}

// Where the arc begins.
Vec3d arc_begin(const Shape& shape, const ShapeBounds& bounds) { return arc_direction(shape, bounds, bounds.begin); }

void script(const Shape& shape, const ShapeBounds& bounds, CommandScript& commands)
{
    const double arc = bounds.end - bounds.begin;
    if (bounds.zero == Vec3d{} || arc >= 2 * pi) {
        const AxisFrame frame(shape.axis);
        commands.coordinate_system(shape.point, frame.u, frame.v);
        commands.line("_.TORUS");
        commands.place({});
        commands.lines({CommandScript::decimal(shape.radius), CommandScript::decimal(shape.second)});
        return;
    }
    // The tube's circle at the arc's beginning, revolved about the axis, which is y here.
    commands.coordinate_system(shape.point, arc_begin(shape, bounds), shape.axis);
    commands.line("_.CIRCLE");
    commands.place({shape.radius, 0, 0});
    commands.line(CommandScript::decimal(shape.second));
    commands.lines({"_.REVOLVE", "_L", ""});
    commands.place({});
    commands.place({0, 1, 0});
    commands.line(CommandScript::decimal(arc * 180 / pi));
}

void solid(const Shape& shape, const ShapeBounds& bounds, ShapeSolids& solids)
{
    const double arc = std::min(bounds.end - bounds.begin, 2 * pi);
    const Vec3d begin = bounds.zero == Vec3d{} ? AxisFrame(shape.axis).u : arc_begin(shape, bounds);
    solids.ring(shape.point, shape.axis, begin, shape.radius, shape.second, bounds.zero == Vec3d{} ? 2 * pi : arc);
}

std::optional<Tube> tube(const Shape& shape, const ShapeBounds& bounds, const ShapeErrors& errors)
{
    if (bounds.zero == Vec3d{} || bounds.end - bounds.begin >= 2 * pi) return {};
    Tube tube;
    tube.radius = shape.second;
    tube.radius_error = errors.second;
    const Vec3d begin = arc_begin(shape, bounds), end = arc_direction(shape, bounds, bounds.end);
    tube.ends = {{{shape.point + shape.radius * begin, cross(begin, shape.axis)},
                  {shape.point + shape.radius * end, cross(shape.axis, end)}}};
    tube.bend = shape.radius;
    tube.centre = shape.point;
    tube.axis = shape.axis;
    tube.arc = bounds.end - bounds.begin;
    tube.place_error = std::hypot(errors.position, errors.radius, errors.angle * shape.radius);
    tube.angle_error = errors.angle;
    return tube;
}

}  // namespace

constexpr ShapeTraits torus_shape{ShapeKind::torus,
                                  "torus",
                                  "Torus",
                                  "torus X Y Z AX AY AZ RADIUS TUBE",
                                  7,
                                  {"centre", "centre", " about "},
                                  ShapeAxis::revolution,
                                  ShapeExtent::closed,
                                  ShapeSizes(sizes),
                                  fault,
                                  distance,
                                  normal,
                                  tube_radius,
                                  shapes::own_place,
                                  shapes::closed_in_box,
                                  shapes::closed_points,
                                  extend,
                                  no_area,
                                  lines,
                                  mesh,
                                  mesh_lines,
                                  draw,
                                  script,
                                  solid,
                                  tube};

}  // namespace pcm
