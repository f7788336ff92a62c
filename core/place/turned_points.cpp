#include "pcm/place/turned_points.h"

#include "pcm/fit/shape_sums.h"
#include "pcm/fit/station_rays.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/refit.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape_traits.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

constexpr double uncertain_way = 0.5;  // share of the way moved that is added to the errors

ShapeSums sums_of(const std::vector<PointOfStation>& points, const Shape& shape, const Box3d& box)
{
    ShapeSums sums(shape, box.centre(), box.diagonal());
    for (const PointOfStation& p : points) sums.add(p.place);
    return sums;
}

// The shape, moved as `from` is moved to `to`.
Shape moved_along(Shape shape, const Shape& from, const Shape& to, const Vec3d& middle)
{
    const ShapeTraits& traits = traits_of(shape.kind);
    shape.point = shape.point + (traits.place_near(to, middle) - traits.place_near(from, middle));
    if (traits.has_axis()) {
        const double side = dot(from.axis, to.axis) < 0 ? -1 : 1, same = dot(shape.axis, from.axis) < 0 ? -1 : 1;
        shape.axis = normalised(shape.axis + same * (side * to.axis - from.axis));
    }
    for (const ShapeSize& size : traits.sizes) shape.*size.value += to.*size.value - from.*size.value;
    return shape;
}

}  // namespace

StationDirections::StationDirections(const Shape& shape, const std::vector<PointOfStation>& points) : shape_(shape)
{
    Box3d box;
    for (const PointOfStation& p : points) box.extend(p.place);
    if (!(box.diagonal() > 0)) return;
    for (const auto& [station, rays] : rays_of(shape, points, box.centre(), box.diagonal()))
        directions_.emplace(station, rays.direction);
}

bool StationDirections::can_see(const Vec3d& p, std::uint32_t station) const
{
    const auto found = directions_.find(station);
    return found == directions_.end() || dot(normal_at(shape_, p), found->second) >= place_tuning().facing.min_cosine;
}

std::vector<PointOfStation> facing_points(const StationDirections& directions,
                                          const std::vector<PointOfStation>& points)
{
    std::vector<PointOfStation> facing;
    for (const PointOfStation& p : points)
        if (directions.can_see(p.place, p.station)) facing.push_back(p);
    return facing;
}

void leave_turned_points(const std::vector<PointOfStation>& points, const std::vector<PointOfStation>& all,
                         double alike, ShapeFit& fit)
{
    Box3d box;
    for (const PointOfStation& p : all) box.extend(p.place);
    const ShapeSums whole = sums_of(all, fit.shape, box), left = sums_of(points, fit.shape, box);
    const std::optional<Shape> from = whole.step(), to = left.step();
    if (!from || !to) return;
    // The points are a sample.
    const double share = static_cast<double>(all.size()) / std::max<double>(static_cast<double>(fit.inliers), 1);
    ShapeErrors least = left.result(fit.threshold).errors;
    enlarge(least, alike * std::sqrt(std::min(1.0, share)));
    fit.errors.position = std::max(fit.errors.position, least.position);
    fit.errors.angle = std::max(fit.errors.angle, least.angle);
    fit.errors.radius = std::max(fit.errors.radius, least.radius);
    fit.errors.second = std::max(fit.errors.second, least.second);
    const Shape before = fit.shape, there = moved_along(before, *from, *to, box.centre());
    correct(there, is_proper(there) ? uncertain_way : 1, box.centre(), fit);
    if (!is_proper(there)) fit.shape = before;
    if (!(is_proper(there) && is_size_certain(fit)))
        doubt(fit, FitIssue::thin_arc,
              "some of its points cannot have been seen there by their stations, and the others leave its size "
              "uncertain: take points farther around it");
}

}  // namespace pcm
