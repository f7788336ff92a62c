// The makers of regions: they check their arguments, and bound the region by a box.
#include "pcm/cloud/region.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pcm {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2;  // of one rounding

[[noreturn]] void refuse(const std::string& region, const std::string& what)
{
    throw Error(ErrorCode::invalid_argument, {}, region + ": " + what);
}

void require_finite(const std::string& region, const char* name, const Vec3d& v)
{
    for (const double c : v)
        if (!std::isfinite(c)) refuse(region, std::string("its ") + name + " is not finite: " + exact(v));
}

void require_length(const std::string& region, const char* name, double length)
{
    if (!(length >= 0) || !std::isfinite(length))
        refuse(region, std::string("its ") + name + " is " + exact(length) + "; it is 0 or more, and finite");
}

// Scaled first: lengths of 1e-200 and 1e200 are fine.
Vec3d unit(const std::string& region, const char* name, const Vec3d& v)
{
    require_finite(region, name, v);
    const double size = largest_magnitude(v);
    if (!(size > 0)) refuse(region, std::string("its ") + name + " has no length");
    const Vec3d near_one = v / size;
    return (1 / length(near_one)) * near_one;
}

std::string words(std::initializer_list<Vec3d> vectors)
{
    std::string text;
    for (const Vec3d& v : vectors) text += " " + exact(v);
    return text;
}

}  // namespace

Region Region::box(const Box3d& box)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (std::isnan(box.min[a]) || std::isnan(box.max[a])) refuse("box", "a corner is NaN");
    Region region;
    region.kind_ = Kind::box;
    region.box_ = region.bounds_ = box;
    if (!box.empty() && is_finite(box.min) && is_finite(box.max)) region.centre_ = box.centre();
    region.text_ = "box" + words({box.min, box.max});
    return region;
}

Region Region::oriented_box(const Vec3d& centre, const std::array<Vec3d, 3>& axes, const Vec3d& half)
{
    const std::string name = "oriented box";
    require_finite(name, "centre", centre);
    std::array<Vec3d, 3> u;
    for (std::size_t k = 0; k < 3; ++k) {
        u[k] = unit(name, "axis", axes[k]);
        require_length(name, "half size", half[k]);
    }
    for (std::size_t k = 1; k < 3; ++k)
        for (std::size_t j = 0; j < k; ++j) {
            if (std::fabs(dot(u[k], u[j])) > 1e-6)
                refuse(name, "its axes" + words({axes[j]}) + " and" + words({axes[k]}) + " are not perpendicular");
        }
    u[1] = unit(name, "axis", u[1] - dot(u[0], u[1]) * u[0]);
    const Vec3d third = unit(name, "axis", cross(u[0], u[1]));
    u[2] = (dot(third, u[2]) < 0 ? -1.0 : 1.0) * third;
    Region region;
    region.kind_ = Kind::oriented_box;
    region.centre_ = centre;
    for (std::size_t k = 0; k < 3; ++k) {
        region.planes_.push_back({u[k], half[k]});
        region.planes_.push_back({-1.0 * u[k], half[k]});
    }
    region.bound_by_planes();
    region.text_ = "oriented-box" + words({centre, half, u[0], u[1]});
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
    region.text_ = "sphere" + words({centre}) + " " + exact(radius);
    return region;
}

Region Region::convex(const Vec3d& centre, const std::vector<Plane>& planes)
{
    const std::string name = "convex region";
    require_finite(name, "centre", centre);
    if (planes.empty() || planes.size() > 64)
        refuse(name, std::to_string(planes.size()) + " planes were given; it has 1 to 64");
    Region region;
    region.kind_ = Kind::convex;
    region.centre_ = centre;
    region.text_ = "planes" + words({centre});
    for (const Plane& plane : planes) {
        require_finite(name, "normal", plane.normal);
        const double size = largest_magnitude(plane.normal);
        if (!(size > 0)) refuse(name, "a plane's normal has no length");
        if (!std::isfinite(plane.offset)) refuse(name, "a plane's offset is not finite");
        // Scaled by a power of two, which rounds nothing.
        const int power = -std::clamp(std::ilogb(size), -1000, 1000);
        Plane near_one{plane.normal, std::ldexp(plane.offset, power)};
        for (double& c : near_one.normal) c = std::ldexp(c, power);
        if (!std::isfinite(near_one.offset)) refuse(name, "a plane's offset is too large beside its normal");
        region.planes_.push_back(near_one);
        region.text_ += words({plane.normal}) + " " + exact(plane.offset);
    }
    region.bound_by_planes();
    return region;
}

Region Region::frustum(const std::array<double, 16>& modelview, const std::array<double, 16>& projection,
                       const Vec3d& origin)
{
    const std::string name = "frustum";
    require_finite(name, "origin", origin);
    for (const auto* matrix : {&modelview, &projection})
        for (const double v : *matrix)
            if (!std::isfinite(v)) refuse(name, "a matrix has an element that is not finite");
    if (modelview[3] != 0 || modelview[7] != 0 || modelview[11] != 0 || modelview[15] == 0)
        refuse(name, "its modelview is not affine");
    std::array<Vec3d, 3> rows;
    Vec3d moved;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) rows[r][c] = modelview[c * 4 + r] / modelview[15];
        moved[r] = modelview[12 + r] / modelview[15];
    }
    // rows * eye = -moved, by Cramer's rule with rows of unit length.
    for (std::size_t r = 0; r < 3; ++r)
        if (!(largest_magnitude(rows[r]) > 0)) refuse(name, "its modelview is singular");
    std::array<Vec3d, 3> turned;
    Vec3d right;
    for (std::size_t r = 0; r < 3; ++r) {
        const double factor = 1 / length(rows[r]);
        turned[r] = factor * rows[r];
        right[r] = -moved[r] * factor;
    }
    const double determinant = dot(turned[0], cross(turned[1], turned[2]));
    if (!(std::fabs(determinant) > 1e-14)) refuse(name, "its modelview is singular");
    Vec3d eye{};
    for (std::size_t r = 0; r < 3; ++r) {
        eye = eye + (right[r] / determinant) * cross(turned[(r + 1) % 3], turned[(r + 2) % 3]);
    }
    // The centre is the rounded eye; the rounding error goes into the offsets of the planes.
    Vec3d centre, rest;
    for (std::size_t a = 0; a < 3; ++a) {
        centre[a] = origin[a] + eye[a];
        const double back = centre[a] - origin[a];
        rest[a] = (origin[a] - (centre[a] - back)) + (eye[a] - back);
    }
    require_finite(name, "eye", centre);
    const auto row = [&](std::size_t r) { return Vec3d{projection[r], projection[4 + r], projection[8 + r]}; };
    std::vector<Plane> planes;
    for (std::size_t r = 0; r < 3; ++r)
        for (const double sign : {1.0, -1.0}) {
            const Vec3d n = row(3) + sign * row(r);
            Plane plane{{}, projection[15] + sign * projection[12 + r]};
            for (std::size_t a = 0; a < 3; ++a)
                plane.normal[a] = n[0] * rows[0][a] + n[1] * rows[1][a] + n[2] * rows[2][a];
            if (largest_magnitude(plane.normal) == 0) {
                if (plane.offset >= 0) continue;  // the far plane of an unbounded view
                refuse(name, "its clip volume is empty");
            }
            plane.offset -= dot(plane.normal, rest);
            planes.push_back(plane);
        }
    if (planes.empty()) refuse(name, "its projection bounds nothing");
    return convex(centre, planes);
}

Region Region::frustum(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double view_angle, double aspect,
                       double near, double far)
{
    const std::string name = "frustum";
    require_finite(name, "eye", eye);
    require_finite(name, "target", target);
    if (!(view_angle > 0 && view_angle < 180))
        refuse(name, "its angle of view is " + exact(view_angle) + "; it is between 0 and 180 degrees");
    if (!(aspect > 0) || !std::isfinite(aspect))
        refuse(name, "its aspect is " + exact(aspect) + "; it is a positive number, width over height");
    if (!(near > 0 && far > near) || !std::isfinite(far))
        refuse(name, "its planes are at " + exact(near) + " and " + exact(far) + "; 0 < near < far is needed");
    const Vec3d forward = unit(name, "direction of view", target - eye);
    const Vec3d upwards = unit(name, "upward direction", up);
    const Vec3d sideways = cross(forward, upwards);
    if (length(sideways) < 1e-9) refuse(name, "its upward direction is parallel to the direction of view");
    const Vec3d right = unit(name, "upward direction", sideways), above = cross(right, forward);
    const double rise = std::tan(view_angle / 360 * pi), run = rise * aspect;
    if (!std::isfinite(run) || !(run > 0)) refuse(name, "its aspect is out of range");
    std::vector<Plane> planes{{forward, -near}, {-1.0 * forward, far}};
    for (const double sign : {1.0, -1.0})
        for (const auto& [side, slope] : {std::pair{right, run}, std::pair{above, rise}}) {
            // side . d <= slope * forward . d, and the same for the opposite side
            planes.push_back({slope * forward - sign * side, 0});
        }
    return convex(eye, planes);
}

Region Region::ray(const Vec3d& origin, const Vec3d& direction, double radius, std::optional<double> length)
{
    require_finite("ray", "origin", origin);
    require_length("ray", "radius", radius);
    if (length) require_length("ray", "length", *length);
    Region region = sphere(origin, radius);
    region.kind_ = Kind::ray;
    region.axis_ = unit("ray", "direction", direction);
    region.length_ = length.value_or(infinity);
    region.bound_radial();
    region.text_ = "ray" + words({origin, direction}) + " " + exact(radius) + (length ? " " + exact(*length) : "");
    return region;
}

Region Region::cone(const Vec3d& apex, const Vec3d& axis, double half_angle, std::optional<double> length)
{
    require_finite("cone", "apex", apex);
    if (!(half_angle > 0 && half_angle < 90))
        refuse("cone", "its half angle is " + exact(half_angle) + "; it is between 0 and 90 degrees, both excluded");
    if (length) require_length("cone", "length", *length);
    Region region;
    region.kind_ = Kind::cone;
    region.centre_ = apex;
    region.axis_ = unit("cone", "axis", axis);
    region.length_ = length.value_or(infinity);
    // Near 90 degrees, the cosine is the sine of the remaining angle.
    region.sine_ = std::sin(half_angle / 180 * pi);
    region.cosine_ = std::sin((90 - half_angle) / 180 * pi);
    region.bound_radial();
    region.text_ = "cone" + words({apex, axis}) + " " + exact(half_angle) + (length ? " " + exact(*length) : "");
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

// The largest e . d of an axis direction e over the region. With multipliers m >= 0 and r = e + sum m_i n_i, each d
// inside has e . d <= sum m_i offset_i + r . d. Three planes and the multipliers that make r vanish give the least
// bound; the residual r that rounding leaves is measured and added.
void Region::bound_by_planes()
{
    bounds_.min.fill(-infinity);
    bounds_.max.fill(infinity);
    std::array<std::array<double, 2>, 3> best;
    for (auto& ends : best) ends.fill(infinity);
    constexpr double most_residual = 1e-6;
    double worst_residual = 0;
    const std::size_t n = planes_.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j)
            for (std::size_t k = j + 1; k < n; ++k) {
                const std::array<const Plane*, 3> three{&planes_[i], &planes_[j], &planes_[k]};
                const std::array<Vec3d, 3> crossed{cross(three[1]->normal, three[2]->normal),
                                                   cross(three[2]->normal, three[0]->normal),
                                                   cross(three[0]->normal, three[1]->normal)};
                const double determinant = dot(three[0]->normal, crossed[0]);
                if (determinant == 0) continue;
                for (std::size_t axis = 0; axis < 3; ++axis)
                    for (std::size_t end = 0; end < 2; ++end) {
                        Vec3d residual{};
                        residual[axis] = end ? 1 : -1;
                        double bound = 0, rounding = 0;
                        for (std::size_t m = 0; m < 3; ++m) {
                            const double multiplier = (end ? -1 : 1) * crossed[m][axis] / determinant;
                            if (!(multiplier > 0)) continue;
                            bound += multiplier * three[m]->offset;
                            for (std::size_t a = 0; a < 3; ++a) {
                                residual[a] += multiplier * three[m]->normal[a];
                                rounding += 4 * epsilon * multiplier * std::fabs(three[m]->normal[a]);
                            }
                        }
                        if (!(largest_magnitude(residual) + rounding <= most_residual) || !(bound < best[axis][end]))
                            continue;
                        best[axis][end] = bound;
                        worst_residual = std::max(worst_residual, largest_magnitude(residual) + rounding);
                    }
            }
    double reach = 0;
    for (const auto& ends : best)
        for (const double end : ends) reach = std::max(reach, std::fabs(end));
    if (!std::isfinite(reach)) return;
    const double margin = 8 * worst_residual * reach;  // |r . d| <= 3 * residual * the largest coordinate of d
    Vec3d low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = -best[a][0] - margin;
        high[a] = best[a][1] + margin;
    }
    set_bounds(low, high);
}

// |d - t u| <= radius, or <= t tan(half_angle): each coordinate of d is at most that plus t times the axis' coordinate.
void Region::bound_radial()
{
    across_[0] = unit("ray", "direction", cross(axis_, std::fabs(axis_[0]) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
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
