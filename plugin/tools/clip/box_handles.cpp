#include "plugin/tools/clip/box_handles.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm::host {

namespace {

// The number t for which `from` + t * axis is nearest to the ray; nothing where the two are parallel.
std::optional<double> nearest_along(const Vec3d& from, const Vec3d& axis, const SceneRay& ray)
{
    constexpr double parallel = 1e-6;  // square of the sine of the angle
    const Vec3d d = ray.from - from;
    const double b = dot(axis, ray.direction), crossed = 1 - b * b;
    if (!(crossed > parallel)) return std::nullopt;
    return (dot(axis, d) - b * dot(ray.direction, d)) / crossed;
}

// Where the ray meets the plane through `place`; nothing where it is nearly in the plane.
std::optional<Vec3d> met(const Vec3d& place, const Vec3d& normal, const SceneRay& ray)
{
    constexpr double edge_on = 1e-2;
    const double falls = dot(normal, ray.direction);
    if (!(std::fabs(falls) > edge_on)) return std::nullopt;
    return ray.from + dot(normal, place - ray.from) / falls * ray.direction;
}

ClipBox with_moved_face(const ClipBox& box, std::size_t axis, double side, double by)
{
    ClipBox moved = box;
    moved.half[axis] = std::max(box.half[axis] + by / 2, least_half(box));
    moved.centre = box.centre + side * (moved.half[axis] - box.half[axis]) * box.axes[axis];
    return moved;
}

ClipBox with_turn(const ClipBox& box, const ViewMap& view, const QPointF& from, const QPointF& to)
{
    const auto a = met(box.centre, box.axes[2], view.ray(from)), b = met(box.centre, box.axes[2], view.ray(to));
    if (!a || !b) return turned(box, (to.x() - from.x()) / 2);  // edge-on: half a degree per pixel
    const auto angle = [&](const Vec3d& p) {
        return std::atan2(dot(p - box.centre, box.axes[1]), dot(p - box.centre, box.axes[0]));
    };
    return turned(box, (angle(*b) - angle(*a)) * 180 / pi);
}

}  // namespace

std::array<BoxHandle, 8> all_handles()
{
    using Kind = BoxHandle::Kind;
    return {{{Kind::face, 0, 1},
             {Kind::face, 0, -1},
             {Kind::face, 1, 1},
             {Kind::face, 1, -1},
             {Kind::face, 2, 1},
             {Kind::face, 2, -1},
             {Kind::turn, 0, 1},
             {Kind::centre, 0, 1}}};
}

Vec3d place_of(const ClipBox& box, const BoxHandle& handle)
{
    switch (handle.kind) {
        case BoxHandle::Kind::face:
            return box.centre + handle.side * box.half[handle.axis] * box.axes[handle.axis];
        case BoxHandle::Kind::turn:
            return box.centre + box.half[0] * box.axes[0] + box.half[1] * box.axes[1];
        default:
            return box.centre;
    }
}

std::array<Vec3d, 8> corners_of(const ClipBox& box)
{
    std::array<Vec3d, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
        corners[i] = box.centre;
        for (std::size_t k = 0; k < 3; ++k)
            corners[i] = corners[i] + ((i >> k & 1) != 0 ? box.half[k] : -box.half[k]) * box.axes[k];
    }
    return corners;
}

std::optional<BoxHandle> handle_at(const ClipBox& box, const ViewMap& view, const QPointF& pixel, double reach)
{
    std::optional<BoxHandle> best;
    double best_distance = reach, best_depth = std::numeric_limits<double>::infinity();
    for (const BoxHandle& handle : all_handles()) {
        const Vec3d place = place_of(box, handle);
        const auto at = view.pixel_of(place);
        if (!at) continue;
        const double distance = std::hypot(at->x() - pixel.x(), at->y() - pixel.y());
        const double depth = -dot(view.back(), place - box.centre);
        if (distance > best_distance + 0.5 || (distance > best_distance - 0.5 && best && depth >= best_depth)) continue;
        if (distance > reach) continue;
        best = handle;
        best_distance = distance;
        best_depth = depth;
    }
    return best;
}

ClipBox dragged(const ClipBox& box, const BoxHandle& handle, const ViewMap& view, const QPointF& from,
                const QPointF& to, bool along_axis)
{
    if (handle.kind == BoxHandle::Kind::turn) return with_turn(box, view, from, to);
    const Vec3d place = place_of(box, handle);
    if (handle.kind == BoxHandle::Kind::face || along_axis) {
        const std::size_t axis = handle.kind == BoxHandle::Kind::face ? handle.axis : thinnest_axis(box);
        const double side = handle.kind == BoxHandle::Kind::face ? handle.side : 1;
        const Vec3d direction = side * box.axes[axis];
        const auto a = nearest_along(place, direction, view.ray(from));
        const auto b = nearest_along(place, direction, view.ray(to));
        if (!a || !b) return box;
        if (handle.kind == BoxHandle::Kind::face) return with_moved_face(box, axis, side, *b - *a);
        ClipBox moved = box;
        moved.centre = box.centre + (*b - *a) * direction;
        return moved;
    }
    const auto a = met(place, view.back(), view.ray(from)), b = met(place, view.back(), view.ray(to));
    ClipBox moved = box;
    if (a && b) moved.centre = box.centre + (*b - *a);
    return moved;
}

double least_half(const ClipBox& box)
{
    constexpr double steps = 64;  // number of steps of double at the place of the box
    return std::max(steps * std::numeric_limits<double>::epsilon() * largest_magnitude(box.centre), 1e-12);
}

std::size_t thinnest_axis(const ClipBox& box)
{
    return static_cast<std::size_t>(std::min_element(box.half.begin(), box.half.end()) - box.half.begin());
}

ClipBox turned(const ClipBox& box, double degrees)
{
    const double c = std::cos(degrees * pi / 180), s = std::sin(degrees * pi / 180);
    ClipBox result = box;
    result.axes[0] = normalised(c * box.axes[0] + s * box.axes[1]);
    result.axes[1] = normalised(cross(box.axes[2], result.axes[0]));
    return result;
}

std::optional<double> turn_of(const ClipBox& box)
{
    constexpr double upright = 1e-9;
    const Vec3d& z = box.axes[2];
    if (!(std::fabs(z[0]) < upright && std::fabs(z[1]) < upright && z[2] > 0)) return std::nullopt;
    const double degrees = std::atan2(box.axes[0][1], box.axes[0][0]) * 180 / pi;
    return degrees <= -180 ? degrees + 360 : degrees;
}

ClipBox box_around(const Box3d& bounds)
{
    ClipBox box;
    box.centre = bounds.centre();
    const double flat = std::max(1e-4 * bounds.diagonal(), least_half(box));
    for (std::size_t a = 0; a < 3; ++a) box.half[a] = std::max(bounds.extent(a) / 2, flat);
    return box;
}

ClipBox box_between(const Vec3d& a, const Vec3d& b, const Box3d& height)
{
    Box3d bounds = height;
    for (std::size_t k = 0; k < 2; ++k) {
        bounds.min[k] = std::min(a[k], b[k]);
        bounds.max[k] = std::max(a[k], b[k]);
    }
    bounds.min[2] = std::min({height.min[2], a[2], b[2]});
    bounds.max[2] = std::max({height.max[2], a[2], b[2]});
    return box_around(bounds);
}

ClipBox section_between(const Vec3d& a, const Vec3d& b, double thickness, const Box3d& height)
{
    const Vec3d line{b[0] - a[0], b[1] - a[1], 0};
    ClipBox box = box_between(a, b, height);
    if (!(length(line) > 2 * least_half(box)))
        throw Error(ErrorCode::invalid_argument, {},
                    "the two points are above each other: no vertical section has both",
                    "pick two points next to each other");
    box.axes[0] = normalised(line);
    box.axes[1] = {-box.axes[0][1], box.axes[0][0], 0};
    box.half[0] = length(line) / 2;
    box.half[1] = std::max(thickness / 2, least_half(box));
    return box;
}

ClipBox slab_of(const ClipBox& box, std::size_t axis, double thickness, const Box3d& bounds)
{
    constexpr double margin = 1.001;  // so that nothing at the border is lost by rounding
    ClipBox slab = box;
    slab.half[axis] = std::max(thickness / 2, least_half(box));
    if (bounds.empty()) return slab;
    for (std::size_t k = 0; k < 3; ++k) {
        if (k == axis) continue;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const Vec3d& corner : corners_of(box_around(bounds))) {
            low = std::min(low, dot(corner - box.centre, box.axes[k]));
            high = std::max(high, dot(corner - box.centre, box.axes[k]));
        }
        slab.half[k] = std::max((high - low) / 2 * margin, least_half(box));
        slab.centre = slab.centre + (low + (high - low) / 2) * box.axes[k];
    }
    return slab;
}

ClipBox stepped(const ClipBox& box, std::size_t axis, double steps)
{
    ClipBox moved = box;
    moved.centre = box.centre + 2 * steps * box.half[axis] * box.axes[axis];
    return moved;
}

}  // namespace pcm::host
