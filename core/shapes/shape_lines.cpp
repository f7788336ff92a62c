#include "pcm/shapes/shape_lines.h"

#include "pcm/shapes/axis_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr double chord_of_radius = 1.0 / 500;
constexpr int least_segments = 8, most_segments = 720;  // of a whole circle
constexpr int lines_around = 8;                         // of a whole circle
constexpr double overhang = 0.05;                       // of its length, an axis is longer at either end
constexpr double normal_length = 0.1;                   // of the outline's diagonal
constexpr double margin = 0.01;                         // of a box around curved lines

struct Frame {
    Vec3d zero{}, quarter{};  // across the axis, perpendicular to each other

    Vec3d at(double angle) const { return std::cos(angle) * zero + std::sin(angle) * quarter; }
};

Frame frame_of(const Vec3d& axis, const Vec3d& zero)
{
    const Vec3d across = zero - dot(zero, axis) * axis;
    if (!(length(across) > 0.5)) {  // not known
        const AxisFrame any(axis);
        return {any.u, any.v};
    }
    const Vec3d unit = normalised(across);
    return {unit, cross(axis, unit)};
}

struct Arc {
    double begin = 0, end = 2 * pi;

    bool whole() const { return end - begin >= 2 * pi * (1 - 1e-12); }
    // Equally spaced angles; the ends of an arc are among them.
    std::vector<double> angles(int around) const
    {
        const int steps =
            whole() ? around : std::max(1, static_cast<int>(std::ceil(around * (end - begin) / (2 * pi))));
        std::vector<double> all;
        for (int i = 0; i < (whole() ? steps : steps + 1); ++i) all.push_back(begin + (end - begin) * i / steps);
        return all;
    }
};

int segments(double radius, const ShapeLineOptions& options)
{
    const double chord = options.chord > 0 ? options.chord : chord_of_radius * radius;
    if (!(chord < radius)) return least_segments;
    const double each = 2 * std::acos(1 - chord / radius);
    return std::clamp(static_cast<int>(std::ceil(2 * pi / std::max(each, 1e-6))), least_segments, most_segments);
}

ShapeLine circle(const Vec3d& centre, const Frame& frame, double radius, const Arc& arc,
                 const ShapeLineOptions& options)
{
    ShapeLine line;
    line.closed = arc.whole();
    for (const double angle : arc.angles(segments(radius, options)))
        line.points.push_back(centre + radius * frame.at(angle));
    return line;
}

std::vector<ShapeLine> plane_lines(const Shape& shape, const ShapeBounds& bounds)
{
    Box3d box;
    for (const Vec3d& corner : bounds.outline) box.extend(corner);
    const Vec3d inside = box.centre();
    const Vec3d middle = inside - dot(shape.axis, inside - shape.point) * shape.axis;
    return {{bounds.outline, true, false},
            {{middle, middle + (normal_length * box.diagonal()) * shape.axis}, false, true}};
}

// Cylinders and cones.
std::vector<ShapeLine> turned_lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options)
{
    const Frame frame = frame_of(shape.axis, bounds.zero);
    const Arc arc{bounds.begin, bounds.end};
    const bool cone = shape.kind == ShapeKind::cone;
    const double from = cone ? std::max(0.0, bounds.from) : bounds.from, to = bounds.to;
    const auto radius = [&](double h) { return cone ? h * std::tan(shape.second) : shape.radius; };
    const auto along = [&](double h) { return shape.point + h * shape.axis; };
    std::vector<ShapeLine> lines;
    for (const double h : {from, (from + to) / 2, to})
        if (radius(h) > 0) lines.push_back(circle(along(h), frame, radius(h), arc, options));
    for (const double angle : arc.angles(lines_around)) {
        const Vec3d out = frame.at(angle);
        lines.push_back({{along(from) + radius(from) * out, along(to) + radius(to) * out}, false, false});
    }
    const double more = overhang * (to - from);
    lines.push_back({{along(from - more), along(to + more)}, false, true});
    return lines;
}

std::vector<ShapeLine> sphere_lines(const Shape& shape, const ShapeLineOptions& options)
{
    const Vec3d up{0, 0, 1};
    const Frame flat = frame_of(up, {1, 0, 0});
    std::vector<ShapeLine> lines;
    for (const double latitude : {-pi / 4, 0.0, pi / 4})
        lines.push_back(circle(shape.point + (shape.radius * std::sin(latitude)) * up, flat,
                               shape.radius * std::cos(latitude), {}, options));
    for (const double angle : Arc{0, pi}.angles(lines_around))
        if (angle < pi * (1 - 1e-9))  // the last meridian is the first one
            lines.push_back(circle(shape.point, {flat.at(angle), up}, shape.radius, {}, options));
    return lines;
}

std::vector<ShapeLine> torus_lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options)
{
    const Frame frame = frame_of(shape.axis, bounds.zero);
    const Arc arc{bounds.begin, bounds.end};
    std::vector<ShapeLine> lines;
    for (const double angle : Arc{}.angles(4))
        lines.push_back(circle(shape.point + (shape.second * std::sin(angle)) * shape.axis, frame,
                               shape.radius + shape.second * std::cos(angle), arc, options));
    for (const double angle : arc.angles(lines_around)) {
        const Vec3d out = frame.at(angle);
        lines.push_back(circle(shape.point + shape.radius * out, {out, shape.axis}, shape.second, {}, options));
    }
    lines.push_back(circle(shape.point, frame, shape.radius, arc, options));
    lines.back().is_axis = true;
    return lines;
}

bool all_finite(const std::vector<ShapeLine>& lines)
{
    for (const ShapeLine& line : lines)
        for (const Vec3d& p : line.points)
            if (!is_finite(p)) return false;
    return true;
}

}  // namespace

std::vector<ShapeLine> shape_lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options)
{
    const bool finite = std::isfinite(bounds.begin) && std::isfinite(bounds.end) && std::isfinite(shape.radius);
    if (!bounds.known(shape.kind) || !finite) return {};
    std::vector<ShapeLine> lines = shape.kind == ShapeKind::plane    ? plane_lines(shape, bounds)
                                   : shape.kind == ShapeKind::sphere ? sphere_lines(shape, options)
                                   : shape.kind == ShapeKind::torus  ? torus_lines(shape, bounds, options)
                                                                     : turned_lines(shape, bounds, options);
    if (!all_finite(lines)) lines.clear();
    return lines;
}

Box3d box_of(const Shape& shape, const ShapeBounds& bounds)
{
    Box3d box;
    for (const ShapeLine& line : shape_lines(shape, bounds))
        if (!line.is_axis)
            for (const Vec3d& p : line.points) box.extend(p);
    if (box.empty() || shape.kind == ShapeKind::plane) return box;
    const double more = margin * box.diagonal();
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= more;
        box.max[a] += more;
    }
    return box;
}

}  // namespace pcm
