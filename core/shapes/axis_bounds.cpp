#include "pcm/shapes/axis_bounds.h"

#include "pcm/cloud/exact_products.h"
#include "pcm/cloud/numbers.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/box_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pcm::shapes {
namespace {

// Places along the axis between which it is in the box (slabs); nothing where it misses the box.
std::optional<std::array<double, 2>> axis_in_box(const Shape& shape, const Box3d& box)
{
    double from = -infinity, to = infinity;
    for (std::size_t a = 0; a < 3; ++a) {
        const double low = box.min[a] - shape.point[a], high = box.max[a] - shape.point[a];
        if (shape.axis[a] == 0) {
            if (low > 0 || high < 0) return {};
            continue;
        }
        const double one = low / shape.axis[a], other = high / shape.axis[a];
        from = std::max(from, std::min(one, other));
        to = std::min(to, std::max(one, other));
    }
    if (!(from <= to) || !std::isfinite(from) || !std::isfinite(to)) return {};
    return {{from, to}};
}

}  // namespace

void set_length(const Shape& shape, double from, double to, ShapeBounds& bounds)
{
    if (traits_of(shape.kind).extent == ShapeExtent::length_from_apex) from = std::max(from, 0.0);
    if (from < to && std::isfinite(from) && std::isfinite(to)) {
        bounds.from = from;
        bounds.to = to;
    }
}

void bound_length_in_box(const Shape& shape, const Box3d& box, ShapeBounds& bounds)
{
    if (const auto inside = axis_in_box(shape, box); inside && (*inside)[0] < (*inside)[1]) {
        set_length(shape, (*inside)[0], (*inside)[1], bounds);
        return;
    }
    double from = infinity, to = -infinity;
    for (unsigned c = 0; c < 8; ++c) {
        const double h = exact_dot(shape.axis, corner_of(box, c) - shape.point);
        from = std::min(from, h);
        to = std::max(to, h);
    }
    set_length(shape, from, to, bounds);
}

void bound_arc(const Shape& shape, const std::vector<Vec3d>& inliers, ShapeBounds& bounds)
{
    const AxisFrame frame(shape.axis);
    std::vector<double> distances, angles;
    for (const Vec3d& p : inliers) distances.push_back(length(exact_cross(shape.axis, p - shape.point)));
    // Near an axis directions are noise.
    const double least = *std::max_element(distances.begin(), distances.end()) / 10;
    for (std::size_t i = 0; i < inliers.size(); ++i)
        if (const double angle = frame.angle_of(inliers[i] - shape.point); distances[i] > least && std::isfinite(angle))
            angles.push_back(angle);
    bounds.zero = frame.u;
    bounds.begin = 0;
    bounds.end = 2 * pi;
    if (angles.size() < 2) return;
    std::sort(angles.begin(), angles.end());
    const double count = static_cast<double>(angles.size());
    double gap = angles.front() + 2 * pi - angles.back();
    std::size_t behind = 0;  // the first angle behind the gap
    for (std::size_t i = 1; i < angles.size(); ++i)
        if (angles[i] - angles[i - 1] > gap) {
            gap = angles[i] - angles[i - 1];
            behind = i;
        }
    // The largest gap of as many random points on a whole circle is about 2 pi ln(n) / n.
    if (!(gap > std::max(pi / 6, 2 * pi * (std::log(count) + 1) / count)) || gap >= 2 * pi) return;
    bounds.begin = angles[behind] < 0 ? angles[behind] + 2 * pi : angles[behind];
    bounds.end = bounds.begin + (2 * pi - gap);
}

void extend_around(const Vec3d& centre, double radius, Box3d& box)
{
    box.extend(centre - Vec3d{radius, radius, radius});
    box.extend(centre + Vec3d{radius, radius, radius});
}

void extend_about_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius, Box3d& box)
{
    for (const double h : {bounds.from, bounds.to}) extend_around(shape.point + h * shape.axis, radius(shape, h), box);
}

}  // namespace pcm::shapes
