// A sphere, always whole.
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

double distance(const Shape& shape, const Vec3d& p) { return length(p - shape.point) - shape.radius; }

Vec3d normal(const Shape& shape, const Vec3d& p)
{
    const Vec3d d = p - shape.point;
    return length(d) > 0 ? normalised(d) : Vec3d{0, 0, 1};
}

void extend(const Shape& shape, const ShapeBounds&, Box3d& box)
{
    shapes::extend_around(shape.point, shape.radius, box);
}

// Meridians and parallels.
std::vector<ShapeLine> lines(const Shape& shape, const ShapeBounds&, const ShapeLineOptions& options)
{
    const Vec3d up{0, 0, 1};
    const shapes::LineFrame flat = shapes::line_frame(up, {1, 0, 0});
    std::vector<ShapeLine> found;
    for (const double latitude : {-pi / 4, 0.0, pi / 4})
        found.push_back(shapes::circle(shape.point + (shape.radius * std::sin(latitude)) * up, flat,
                                       shape.radius * std::cos(latitude), {}, options));
    for (const double angle : shapes::Arc{0, pi}.angles(shapes::lines_around))
        if (angle < pi * (1 - 1e-9))  // the last meridian is the first one
            found.push_back(shapes::circle(shape.point, {flat.at(angle), up}, shape.radius, {}, options));
    return found;
}

double chord_of(const Shape& shape, const MeshOptions& options)
{
    return options.chord > 0 ? options.chord : shape.radius / 50;
}

void mesh(const Shape& shape, const ShapeBounds&, const MeshOptions& options, const FaceVisitor& visit)
{
    const double chord = chord_of(shape, options);
    // Faces are off by what both directions add.
    const std::size_t around = shapes::segments(shape.radius, chord / 2, 2 * pi),
                      rows = shapes::segments(shape.radius, chord / 2, pi);
    shapes::check_faces(around, rows, chord);
    const auto at = [&](std::size_t i, std::size_t j) {
        const double turn = 2 * pi * static_cast<double>(i % around) / static_cast<double>(around);
        const double height = pi * (static_cast<double>(j) / static_cast<double>(rows) - 0.5);
        const double across = j == 0 || j == rows ? 0 : std::cos(height);
        const Vec3d direction{across * std::cos(turn), across * std::sin(turn), std::sin(height)};
        return shape.point + shape.radius * direction;
    };
    for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t i = 0; i < around; ++i) {
            if (j == 0)
                visit({at(i, 0), at(i + 1, 1), at(i, 1), at(i, 1)});
            else if (j + 1 == rows)
                visit({at(i, j), at(i + 1, j), at(i, rows), at(i, rows)});
            else
                visit({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
}

// Three great circles.
void mesh_lines(const Shape& shape, const ShapeBounds&, const MeshOptions& options, ShapeLines& found)
{
    const double chord = chord_of(shape, options);
    const std::size_t count = shapes::segments(shape.radius, chord / 2, 2 * pi);
    shapes::check_faces(count, shapes::segments(shape.radius, chord / 2, pi), chord);
    found.circles.push_back({shape.point, shape.radius});
    found.lines.push_back(shapes::ring(shape.point, {1, 0, 0}, {0, 0, 1}, shape.radius, count));
    found.lines.push_back(shapes::ring(shape.point, {0, 1, 0}, {0, 0, 1}, shape.radius, count));
}

std::string draw(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeDrawing& drawing)
{
    draw_faces(shape, bounds, options, drawing);
    draw_lines(shape, bounds, options, drawing);
    return {};
}

void script(const Shape& shape, const ShapeBounds&, CommandScript& commands)
{
    commands.coordinate_system(shape.point, {1, 0, 0}, {0, 1, 0});
    commands.line("_.SPHERE");
    commands.place({});
    commands.line(CommandScript::decimal(shape.radius));
}

void solid(const Shape& shape, const ShapeBounds&, ShapeSolids& solids) { solids.ball(shape.point, shape.radius); }

}  // namespace

constexpr ShapeTraits sphere_shape{ShapeKind::sphere,
                                   "sphere",
                                   "Sphere",
                                   "sphere X Y Z RADIUS",
                                   4,
                                   {"centre", "centre", " about "},
                                   ShapeAxis::none,
                                   ShapeExtent::closed,
                                   ShapeSizes(sizes),
                                   shapes::no_fault,
                                   distance,
                                   normal,
                                   shapes::own_radius,
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
                                   no_tube};

}  // namespace pcm
