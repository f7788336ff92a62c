#include "pcm/shapes/shape_mesh.h"

#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/flat_points.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr double most_faces = 1e6;

using Visit = std::function<void(const MeshFace&)>;

// Segments of an arc of this radius that are nowhere farther than `chord` from it.
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

// Directions across the axis at equal angles of an arc.
class Fan {
public:
    Fan(const Shape& shape, const ShapeBounds& bounds, bool whole, double radius, double chord)
        : v_(cross(shape.axis, zero_of(shape, bounds))),
          u_(cross(v_, shape.axis)),
          begin_(whole ? 0 : bounds.begin),
          arc_(whole ? 2 * pi : bounds.end - bounds.begin),
          whole_(whole || arc_ >= 2 * pi),
          count_(segments(radius, chord, arc_))
    {
    }
    std::size_t count() const { return count_; }
    bool whole() const { return whole_; }
    Vec3d at(std::size_t i) const
    {
        const double part = static_cast<double>(whole_ ? i % count_ : i) / static_cast<double>(count_);
        const double angle = begin_ + arc_ * part;
        return std::cos(angle) * u_ + std::sin(angle) * v_;
    }

private:
    static Vec3d zero_of(const Shape& shape, const ShapeBounds& bounds)
    {
        const Vec3d zero = length(bounds.zero) > 0.5 ? bounds.zero : AxisFrame(shape.axis).u;
        return normalised(zero - dot(zero, shape.axis) * shape.axis);
    }
    Vec3d v_, u_;
    double begin_, arc_;
    bool whole_;
    std::size_t count_;
};

// A flat polygon as triangles from its first corner.
void cap(const std::vector<Vec3d>& corners, bool reversed, const Visit& visit)
{
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const Vec3d &b = corners[reversed ? i + 1 : i], &c = corners[reversed ? i : i + 1];
        visit({corners[0], b, c, c});
    }
}

// The corners of a cylinder's or cone's mesh.
struct AboutAxis {
    AboutAxis(const Shape& of, const ShapeBounds& bounds, const MeshOptions& options)
        : shape(of),
          from_apex(of.kind == ShapeKind::cone && bounds.from <= 0),
          chord(options.chord > 0 ? options.chord : radius_at(bounds.to) / 100),
          fan(of, bounds, !options.arcs, radius_at(bounds.to), chord)
    {
        check_faces(fan.count(), 3, chord);
    }
    double radius_at(double h) const
    {
        return shape.kind == ShapeKind::cone ? h * std::tan(shape.second) : shape.radius;
    }
    Vec3d at(std::size_t i, double h) const { return shape.point + (h * shape.axis + radius_at(h) * fan.at(i)); }

    const Shape& shape;
    bool from_apex;
    double chord;
    Fan fan;
};

void mesh_about_axis(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const Visit& visit)
{
    if (!bounds.known(shape.kind)) return;
    const AboutAxis about(shape, bounds, options);
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

void mesh_sphere(const Shape& shape, const MeshOptions& options, const Visit& visit)
{
    const double chord = options.chord > 0 ? options.chord : shape.radius / 100;
    // Faces are off by what both directions add.
    const std::size_t around = segments(shape.radius, chord / 2, 2 * pi), rows = segments(shape.radius, chord / 2, pi);
    check_faces(around, rows, chord);
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

void mesh_torus(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const Visit& visit)
{
    const double chord = options.chord > 0 ? options.chord : shape.second / 100;
    const Fan fan(shape, bounds, false, shape.radius + shape.second, chord / 2);
    const std::size_t tube = segments(shape.second, chord / 2, 2 * pi);
    check_faces(fan.count(), tube, chord);
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
        cap(corners, last, visit);
    }
}

// At the beginning, the quarters and the end of an arc of so many segments.
std::vector<std::size_t> quarters(std::size_t segments, bool whole)
{
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < (whole ? 4u : 5u); ++k) places.push_back(k * segments / 4);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
}

void lines_about_axis(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeLines& found)
{
    if (!bounds.known(shape.kind)) return;
    const AboutAxis about(shape, bounds, options);
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

// A circle of so many corners through two directions.
ShapeLines::Line ring(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double radius, std::size_t count)
{
    std::vector<Vec3d> corners;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2 * pi * static_cast<double>(i) / static_cast<double>(count);
        corners.push_back(centre + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return {std::move(corners), true};
}

void lines_of_torus(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeLines& found)
{
    const double chord = options.chord > 0 ? options.chord : shape.second / 100;
    const Fan fan(shape, bounds, false, shape.radius + shape.second, chord / 2);
    const std::size_t tube = segments(shape.second, chord / 2, 2 * pi);
    check_faces(fan.count(), tube, chord);
    for (const auto& [out, up] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}) {
        std::vector<Vec3d> corners;
        for (std::size_t i = 0; i < fan.count() + (fan.whole() ? 0 : 1); ++i)
            corners.push_back(shape.point +
                              ((shape.radius + out * shape.second) * fan.at(i) + up * shape.second * shape.axis));
        found.lines.push_back({std::move(corners), fan.whole()});
    }
    for (const std::size_t i : quarters(fan.count(), fan.whole()))
        found.lines.push_back(ring(shape.point + shape.radius * fan.at(i), fan.at(i), shape.axis, shape.second, tube));
}

// Clips ears of a polygon on a grid of integers, on which turns are exact.
class EarClipper {
public:
    explicit EarClipper(std::vector<FlatPoint> corners) : corners_(std::move(corners))
    {
        const auto count = static_cast<std::uint32_t>(corners_.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            before_.push_back(i == 0 ? count - 1 : i - 1);
            after_.push_back(i + 1 == count ? 0 : i + 1);
        }
    }
    std::vector<std::array<std::uint32_t, 3>> clip()
    {
        for (std::uint32_t i = 0; i < corners_.size(); ++i)
            if (turn_at(i) <= 0) reflex_.push_back(i);
        std::size_t left = corners_.size(), tried = 0;
        for (std::uint32_t i = 0; left > 3 && tried <= left;) {
            if (!is_ear(i)) {
                i = after_[i];
                ++tried;
                continue;
            }
            triangles_.push_back({before_[i], i, after_[i]});
            after_[before_[i]] = after_[i];
            before_[after_[i]] = before_[i];
            // Clipped corners, and those that no longer point inwards, are in nobody's way.
            const std::uint32_t gone = i;
            reflex_.erase(std::remove_if(reflex_.begin(), reflex_.end(),
                                         [&](std::uint32_t r) { return r == gone || turn_at(r) > 0; }),
                          reflex_.end());
            i = after_[i];
            i = after_[i];  // not all from one corner
            first_ = i;
            --left;
            tried = 0;
        }
        if (left != 3 || turn_at(first_) <= 0) return {};
        triangles_.push_back({before_[first_], first_, after_[first_]});
        return triangles_;
    }

private:
    std::int64_t turn_at(std::uint32_t i) const
    {
        return turn_of(corners_[before_[i]], corners_[i], corners_[after_[i]]);
    }
    bool is_ear(std::uint32_t i) const
    {
        if (turn_at(i) <= 0) return false;
        const FlatPoint &a = corners_[before_[i]], &b = corners_[i], &c = corners_[after_[i]];
        return std::none_of(reflex_.begin(), reflex_.end(), [&](std::uint32_t r) {
            const FlatPoint& p = corners_[r];
            return r != i && r != before_[i] && r != after_[i] && turn_of(a, b, p) >= 0 && turn_of(b, c, p) >= 0 &&
                   turn_of(c, a, p) >= 0;
        });
    }

    std::vector<FlatPoint> corners_;
    std::vector<std::uint32_t> before_, after_, reflex_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::uint32_t first_ = 0;  // a corner that is left
};

void check(const MeshOptions& options)
{
    if (!(options.chord >= 0 && std::isfinite(options.chord)))
        throw Error(ErrorCode::invalid_argument, {}, "the chord tolerance is not 0 or above");
}

}  // namespace

void mesh_shape(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const Visit& visit)
{
    check(shape);
    check(options);
    if (shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone)
        mesh_about_axis(shape, bounds, options, visit);
    if (shape.kind == ShapeKind::sphere) mesh_sphere(shape, options, visit);
    if (shape.kind == ShapeKind::torus) mesh_torus(shape, bounds, options, visit);
}

ShapeLines lines_of(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options)
{
    check(shape);
    check(options);
    ShapeLines found;
    if (shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone)
        lines_about_axis(shape, bounds, options, found);
    if (shape.kind == ShapeKind::sphere) {
        const double chord = options.chord > 0 ? options.chord : shape.radius / 100;
        const std::size_t count = segments(shape.radius, chord / 2, 2 * pi);
        check_faces(count, segments(shape.radius, chord / 2, pi), chord);
        found.circles.push_back({shape.point, shape.radius});
        found.lines.push_back(ring(shape.point, {1, 0, 0}, {0, 0, 1}, shape.radius, count));
        found.lines.push_back(ring(shape.point, {0, 1, 0}, {0, 0, 1}, shape.radius, count));
    }
    if (shape.kind == ShapeKind::torus) lines_of_torus(shape, bounds, options, found);
    return found;
}

std::vector<std::array<std::uint32_t, 3>> triangulate_outline(const std::vector<Vec3d>& outline, const Vec3d& normal)
{
    if (outline.size() < 3) return {};
    const AxisFrame frame(normal);
    std::vector<Vec2d> flat;
    for (const Vec3d& p : outline) flat.push_back({dot(p - outline[0], frame.u), dot(p - outline[0], frame.v)});
    const FlatPoints sorted(flat);
    if (sorted.size() != outline.size()) return {};
    std::vector<FlatPoint> corners(outline.size());
    for (const FlatPoint& p : sorted.points()) corners[p.index] = p;
    return EarClipper(std::move(corners)).clip();
}

}  // namespace pcm
