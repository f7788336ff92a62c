#include "pcm/shapes/axis_mesh.h"

#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm::shapes {
namespace {

constexpr double most_faces = 1e6;

Vec3d zero_of(const Shape& shape, const ShapeBounds& bounds)
{
    const Vec3d zero = length(bounds.zero) > 0.5 ? bounds.zero : AxisFrame(shape.axis).u;
    return normalised(zero - dot(zero, shape.axis) * shape.axis);
}

// The corners of a mesh between two places along the axis.
struct AboutAxis {
    AboutAxis(const Shape& of, const ShapeBounds& bounds, RadiusAt radius, const MeshOptions& options)
        : shape(of),
          radius_of(radius),
          from_apex(traits_of(of.kind).extent == ShapeExtent::length_from_apex && bounds.from <= 0),
          chord(options.chord > 0 ? options.chord : radius_at(bounds.to) / 100),
          fan(of, bounds, !options.arcs, radius_at(bounds.to), chord)
    {
        check_faces(fan.count(), 3, chord);
    }
    double radius_at(double h) const { return radius_of(shape, h); }
    Vec3d at(std::size_t i, double h) const { return shape.point + (h * shape.axis + radius_at(h) * fan.at(i)); }

    const Shape& shape;
    RadiusAt radius_of;
    bool from_apex;
    double chord;
    Fan fan;
};

}  // namespace

std::size_t segments(double radius, double chord, double arc)
{
    const double half = 2 * std::asin(std::sqrt(std::min(0.5, chord / (2 * radius))));  // chord = radius (1 - cos half)
    const double least = std::max(1.0, std::ceil(arc / (pi / 4)));
    return static_cast<std::size_t>(std::min(most_faces, std::max(least, std::ceil(arc / (2 * half) - 1e-9))));
}

void check_faces(std::size_t across, std::size_t along, double chord)
{
    if (static_cast<double>(across) * static_cast<double>(along) > most_faces)
        throw Error(ErrorCode::invalid_argument, {},
                    "a chord tolerance of " + brief(chord) + " takes more than 1,000,000 faces", "choose a larger one");
}

Fan::Fan(const Shape& shape, const ShapeBounds& bounds, bool whole, double radius, double chord)
    : v_(cross(shape.axis, zero_of(shape, bounds))),
      u_(cross(v_, shape.axis)),
      begin_(whole ? 0 : bounds.begin),
      arc_(whole ? 2 * pi : bounds.end - bounds.begin),
      whole_(whole || arc_ >= 2 * pi),
      count_(segments(radius, chord, arc_))
{
}

Vec3d Fan::at(std::size_t i) const
{
    const double part = static_cast<double>(whole_ ? i % count_ : i) / static_cast<double>(count_);
    const double angle = begin_ + arc_ * part;
    return std::cos(angle) * u_ + std::sin(angle) * v_;
}

void cap(const std::vector<Vec3d>& corners, bool reversed, const FaceVisitor& visit)
{
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const Vec3d &b = corners[reversed ? i + 1 : i], &c = corners[reversed ? i : i + 1];
        visit({corners[0], b, c, c});
    }
}

std::vector<std::size_t> quarters(std::size_t segments, bool whole)
{
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < (whole ? 4u : 5u); ++k) places.push_back(k * segments / 4);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
}

ShapeLines::Line ring(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double radius, std::size_t count)
{
    std::vector<Vec3d> corners;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2 * pi * static_cast<double>(i) / static_cast<double>(count);
        corners.push_back(centre + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return {std::move(corners), true};
}

void mesh_along_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius, const MeshOptions& options,
                     const FaceVisitor& visit)
{
    if (!bounds.known(shape.kind)) return;
    const AboutAxis about(shape, bounds, radius, options);
    const Fan& fan = about.fan;
    const bool from_apex = about.from_apex;
    const auto at = [&](std::size_t i, double h) { return about.at(i, h); };
    for (std::size_t i = 0; i < fan.count(); ++i) {
        const Vec3d c = at(i + 1, bounds.to), d = at(i, bounds.to);
        if (from_apex)
            visit({shape.point, c, d, d});
        else
            visit({at(i, bounds.from), at(i + 1, bounds.from), c, d});
    }
    if (!fan.whole()) return;
    for (const double h : {bounds.from, bounds.to}) {
        if (h == bounds.from && from_apex) continue;
        std::vector<Vec3d> corners;
        for (std::size_t i = 0; i < fan.count(); ++i) corners.push_back(at(i, h));
        cap(corners, h == bounds.from, visit);
    }
}

void mesh_lines_along_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius, const MeshOptions& options,
                           ShapeLines& found)
{
    if (!bounds.known(shape.kind)) return;
    const AboutAxis about(shape, bounds, radius, options);
    const Fan& fan = about.fan;
    const bool is_upright = shape.axis[0] == 0 && shape.axis[1] == 0;
    for (const double h : {bounds.from, bounds.to}) {
        if (h == bounds.from && about.from_apex) continue;
        if (is_upright && fan.whole()) {
            found.circles.push_back({shape.point + h * shape.axis, about.radius_at(h)});
            continue;
        }
        std::vector<Vec3d> corners;
        for (std::size_t i = 0; i < fan.count() + (fan.whole() ? 0 : 1); ++i) corners.push_back(about.at(i, h));
        found.lines.push_back({std::move(corners), fan.whole()});
    }
    for (const std::size_t i : quarters(fan.count(), fan.whole()))
        found.lines.push_back(
            {{about.from_apex ? shape.point : about.at(i, bounds.from), about.at(i, bounds.to)}, false});
}

}  // namespace pcm::shapes
