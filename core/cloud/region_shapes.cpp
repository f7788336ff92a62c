// The makers of regions: they check their arguments, and bound the region by a box.
#include "pcm/cloud/region.h"

#include "pcm/cloud/numbers.h"
#include "pcm/cloud/region_checks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

void require_length(const std::string& region, const char* name, double length)
{
    if (!(length >= 0) || !std::isfinite(length))
        refuse_region(region, std::string("its ") + name + " is " + exact(length) + "; it is 0 or more, and finite");
}

}  // namespace

Region Region::box(const Box3d& box)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (std::isnan(box.min[a]) || std::isnan(box.max[a])) refuse_region("box", "a corner is NaN");
    Region region;
    region.kind_ = Kind::box;
    region.box_ = region.bounds_ = box;
    if (!box.empty() && is_finite(box.min) && is_finite(box.max)) region.centre_ = box.centre();
    region.text_ = "box" + text_of({box.min, box.max});
    return region;
}

Region Region::oriented_box(const Vec3d& centre, const std::array<Vec3d, 3>& axes, const Vec3d& half)
{
    const std::string name = "oriented box";
    require_finite(name, "centre", centre);
    std::array<Vec3d, 3> u;
    for (std::size_t k = 0; k < 3; ++k) {
        u[k] = unit_vector(name, "axis", axes[k]);
        require_length(name, "half size", half[k]);
    }
    for (std::size_t k = 1; k < 3; ++k)
        for (std::size_t j = 0; j < k; ++j) {
            if (std::fabs(dot(u[k], u[j])) > 1e-6)
                refuse_region(name,
                              "its axes" + text_of({axes[j]}) + " and" + text_of({axes[k]}) + " are not perpendicular");
        }
    u[1] = unit_vector(name, "axis", u[1] - dot(u[0], u[1]) * u[0]);
    const Vec3d third = unit_vector(name, "axis", cross(u[0], u[1]));
    u[2] = (dot(third, u[2]) < 0 ? -1.0 : 1.0) * third;
    Region region;
    region.kind_ = Kind::oriented_box;
    region.centre_ = centre;
    for (std::size_t k = 0; k < 3; ++k) {
        region.planes_.push_back({u[k], half[k]});
        region.planes_.push_back({-1.0 * u[k], half[k]});
    }
    region.bound_by_planes();
    region.text_ = "oriented-box" + text_of({centre, half, u[0], u[1]});
    return region;
}

Region Region::sphere(const Vec3d& centre, double radius)
{
    require_finite("sphere", "centre", centre);
    require_length("sphere", "radius", radius);
    Region region;
    region.kind_ = Kind::sphere;
    region.centre_ = centre;
    region.radius_ = radius;
    if (radius > 0) region.inverse_unit_ = std::ldexp(1.0, -std::clamp(std::ilogb(radius), -1000, 1000));
    const double scaled_radius = radius * region.inverse_unit_;
    region.scaled_square_ = scaled_radius * scaled_radius;
    region.set_bounds({-radius, -radius, -radius}, {radius, radius, radius});
    region.text_ = "sphere" + text_of({centre}) + " " + exact(radius);
    return region;
}

Region Region::ray(const Vec3d& origin, const Vec3d& direction, double radius, std::optional<double> length)
{
    require_finite("ray", "origin", origin);
    require_length("ray", "radius", radius);
    if (length) require_length("ray", "length", *length);
    Region region = sphere(origin, radius);
    region.kind_ = Kind::ray;
    region.axis_ = unit_vector("ray", "direction", direction);
    region.length_ = length.value_or(infinity);
    region.bound_radial();
    region.text_ = "ray" + text_of({origin, direction}) + " " + exact(radius) + (length ? " " + exact(*length) : "");
    return region;
}

Region Region::cone(const Vec3d& apex, const Vec3d& axis, double half_angle, std::optional<double> length)
{
    require_finite("cone", "apex", apex);
    if (!(half_angle > 0 && half_angle < 90))
        refuse_region("cone",
                      "its half angle is " + exact(half_angle) + "; it is between 0 and 90 degrees, both excluded");
    if (length) require_length("cone", "length", *length);
    Region region;
    region.kind_ = Kind::cone;
    region.centre_ = apex;
    region.axis_ = unit_vector("cone", "axis", axis);
    region.length_ = length.value_or(infinity);
    // Near 90 degrees, the cosine is the sine of the remaining angle.
    region.sine_ = std::sin(half_angle / 180 * pi);
    region.cosine_ = std::sin((90 - half_angle) / 180 * pi);
    region.bound_radial();
    region.text_ = "cone" + text_of({apex, axis}) + " " + exact(half_angle) + (length ? " " + exact(*length) : "");
    return region;
}

void Region::set_bounds(const Vec3d& low, const Vec3d& high)
{
    for (std::size_t a = 0; a < 3; ++a) {
        const double from = low[a] - std::fabs(low[a]) * 1e-12, to = high[a] + std::fabs(high[a]) * 1e-12;
        // Two units in the last place: one for this sum, one for p - centre.
        bounds_.min[a] = std::nextafter(std::nextafter(centre_[a] + from, -infinity), -infinity);
        bounds_.max[a] = std::nextafter(std::nextafter(centre_[a] + to, infinity), infinity);
    }
}

// |d - t u| <= radius, or <= t tan(half_angle): each coordinate of d is at most that plus t times the axis' coordinate.
void Region::bound_radial()
{
    across_[0] =
        unit_vector("ray", "direction", cross(axis_, std::fabs(axis_[0]) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
    across_[1] = cross(axis_, across_[0]);
    const double slope = kind_ == Kind::cone ? sine_ / cosine_ * (1 + 1e-12) + 1e-12 : 0;
    const auto reach = [&](double along) {
        const double rate = along + slope;
        return rate > 0 ? (length_ > 0 ? length_ * rate : 0.0) : 0.0;
    };
    const double radius = kind_ == Kind::ray ? radius_ * (1 + 1e-12) : 0;
    Vec3d low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = -reach(-axis_[a]) - radius;
        high[a] = reach(axis_[a]) + radius;
    }
    set_bounds(low, high);
}

}  // namespace pcm
