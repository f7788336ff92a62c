#include "pcm/shapes/axis_lines.h"

#include "pcm/shapes/axis_frame.h"

#include <algorithm>
#include <cmath>

namespace pcm::shapes {
namespace {

constexpr double chord_of_radius = 1.0 / 500;
constexpr int least_segments = 8, most_segments = 720;  // per whole circle
constexpr double overhang = 0.05;                       // an axis is longer at either end: share of its length

int segments(double radius, const ShapeLineOptions& options)
{
    const double chord = options.chord > 0 ? options.chord : chord_of_radius * radius;
    if (!(chord < radius)) return least_segments;
    const double each = 2 * std::acos(1 - chord / radius);
    return std::clamp(static_cast<int>(std::ceil(2 * pi / std::max(each, 1e-6))), least_segments, most_segments);
}

}  // namespace

Vec3d LineFrame::at(double angle) const { return std::cos(angle) * zero + std::sin(angle) * quarter; }

LineFrame line_frame(const Vec3d& axis, const Vec3d& zero)
{
    const Vec3d across = zero - dot(zero, axis) * axis;
    if (!(length(across) > 0.5)) {  // not known
        const AxisFrame any(axis);
        return {any.u, any.v};
    }
    const Vec3d unit = normalised(across);
    return {unit, cross(axis, unit)};
}

std::vector<double> Arc::angles(int around) const
{
    const int steps = whole() ? around : std::max(1, static_cast<int>(std::ceil(around * (end - begin) / (2 * pi))));
    std::vector<double> all;
    for (int i = 0; i < (whole() ? steps : steps + 1); ++i) all.push_back(begin + (end - begin) * i / steps);
    return all;
}

ShapeLine circle(const Vec3d& centre, const LineFrame& frame, double radius, const Arc& arc,
                 const ShapeLineOptions& options)
{
    ShapeLine line;
    line.closed = arc.whole();
    for (const double angle : arc.angles(segments(radius, options)))
        line.points.push_back(centre + radius * frame.at(angle));
    return line;
}

std::vector<ShapeLine> lines_along_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius_at,
                                        const ShapeLineOptions& options)
{
    const LineFrame frame = line_frame(shape.axis, bounds.zero);
    const Arc arc{bounds.begin, bounds.end};
    const bool has_apex = traits_of(shape.kind).extent == ShapeExtent::length_from_apex;
    const double from = has_apex ? std::max(0.0, bounds.from) : bounds.from, to = bounds.to;
    const auto radius = [&](double h) { return radius_at(shape, h); };
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

}  // namespace pcm::shapes
