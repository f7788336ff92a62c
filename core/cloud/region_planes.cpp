// Regions that planes and polygons bound: convex volumes, what a view shows, prisms, lassos.
#include "pcm/cloud/numbers.h"
#include "pcm/cloud/region.h"
#include "pcm/cloud/region_checks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

// A view from its eye: a point p is at rows * (d - rest) in eye space, with d = p - centre.
struct ViewFrame {
    std::array<Vec3d, 3> rows;  // rows of the modelview
    Vec3d centre, rest;
};

ViewFrame view_frame(const std::string& name, const std::array<double, 16>& modelview,
                     const std::array<double, 16>& projection, const Vec3d& origin)
{
    require_finite(name, "origin", origin);
    for (const auto* matrix : {&modelview, &projection})
        for (const double v : *matrix)
            if (!std::isfinite(v)) refuse_region(name, "a matrix has an element that is not finite");
    if (modelview[3] != 0 || modelview[7] != 0 || modelview[11] != 0 || modelview[15] == 0)
        refuse_region(name, "its modelview is not affine");
    ViewFrame frame;
    std::array<Vec3d, 3>& rows = frame.rows;
    Vec3d moved;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) rows[r][c] = modelview[c * 4 + r] / modelview[15];
        moved[r] = modelview[12 + r] / modelview[15];
    }
    // rows * eye = -moved, by Cramer's rule with rows of unit length.
    for (std::size_t r = 0; r < 3; ++r)
        if (!(largest_magnitude(rows[r]) > 0)) refuse_region(name, "its modelview is singular");
    std::array<Vec3d, 3> turned;
    Vec3d right;
    for (std::size_t r = 0; r < 3; ++r) {
        const double factor = 1 / length(rows[r]);
        turned[r] = factor * rows[r];
        right[r] = -moved[r] * factor;
    }
    const double determinant = dot(turned[0], cross(turned[1], turned[2]));
    if (!(std::fabs(determinant) > 1e-14)) refuse_region(name, "its modelview is singular");
    Vec3d eye{};
    for (std::size_t r = 0; r < 3; ++r) {
        eye = eye + (right[r] / determinant) * cross(turned[(r + 1) % 3], turned[(r + 2) % 3]);
    }
    // The centre is the rounded eye; the rounding error goes into the offsets of the planes.
    for (std::size_t a = 0; a < 3; ++a) {
        frame.centre[a] = origin[a] + eye[a];
        const double back = frame.centre[a] - origin[a];
        frame.rest[a] = (origin[a] - (frame.centre[a] - back)) + (eye[a] - back);
    }
    require_finite(name, "eye", frame.centre);
    return frame;
}

Polygon polygon_of(const std::string& region, const std::vector<Vec2d>& corners)
{
    if (corners.size() < 3)
        refuse_region(region, std::to_string(corners.size()) + " corners were given; a polygon has 3 or more");
    for (const Vec2d& corner : corners)
        for (const double c : corner)
            if (!(std::fabs(c) <= Polygon::largest()))
                refuse_region(region, "a corner is at " + exact(corner[0]) + " " + exact(corner[1]) +
                                          "; coordinates of corners are finite, and at most 1e150");
    return Polygon(corners);
}

std::string text_of(const std::vector<Vec2d>& corners)
{
    std::string text;
    for (const Vec2d& corner : corners) text += " " + exact(corner[0]) + " " + exact(corner[1]);
    return text;
}

std::string text_of(const std::array<double, 16>& matrix)
{
    std::string text;
    for (const double v : matrix) text += " " + exact(v);
    return text;
}

}  // namespace

Region Region::convex(const Vec3d& centre, const std::vector<Plane>& planes)
{
    const std::string name = "convex region";
    require_finite(name, "centre", centre);
    if (planes.empty() || planes.size() > 64)
        refuse_region(name, std::to_string(planes.size()) + " planes were given; it has 1 to 64");
    Region region;
    region.kind_ = Kind::convex;
    region.centre_ = centre;
    region.text_ = "planes" + text_of({centre});
    for (const Plane& plane : planes) {
        region.add_plane(name, plane);
        region.text_ += text_of({plane.normal}) + " " + exact(plane.offset);
    }
    region.bound_by_planes();
    return region;
}

void Region::add_plane(const std::string& name, const Plane& plane)
{
    require_finite(name, "normal", plane.normal);
    const double size = largest_magnitude(plane.normal);
    if (!(size > 0)) refuse_region(name, "a plane's normal has no length");
    if (!std::isfinite(plane.offset)) refuse_region(name, "a plane's offset is not finite");
    // Scaled by a power of two, which rounds nothing.
    const int power = -std::clamp(std::ilogb(size), -1000, 1000);
    Plane near_one{plane.normal, std::ldexp(plane.offset, power)};
    for (double& c : near_one.normal) c = std::ldexp(c, power);
    if (!std::isfinite(near_one.offset)) refuse_region(name, "plane offset out of range for its normal");
    planes_.push_back(near_one);
}

Region Region::frustum(const std::array<double, 16>& modelview, const std::array<double, 16>& projection,
                       const Vec3d& origin)
{
    const std::string name = "frustum";
    const ViewFrame frame = view_frame(name, modelview, projection, origin);
    const std::array<Vec3d, 3>& rows = frame.rows;
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
                refuse_region(name, "its clip volume is empty");
            }
            plane.offset -= dot(plane.normal, frame.rest);
            planes.push_back(plane);
        }
    if (planes.empty()) refuse_region(name, "its projection bounds nothing");
    return convex(frame.centre, planes);
}

Region Region::frustum(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double view_angle, double aspect,
                       double near, double far)
{
    const std::string name = "frustum";
    require_finite(name, "eye", eye);
    require_finite(name, "target", target);
    if (!(view_angle > 0 && view_angle < 180))
        refuse_region(name, "its angle of view is " + exact(view_angle) + "; it is between 0 and 180 degrees");
    if (!(aspect > 0) || !std::isfinite(aspect))
        refuse_region(name, "its aspect is " + exact(aspect) + "; it is a positive number, width over height");
    if (!(near > 0 && far > near) || !std::isfinite(far))
        refuse_region(name, "its planes are at " + exact(near) + " and " + exact(far) + "; 0 < near < far is needed");
    const Vec3d forward = unit_vector(name, "direction of view", target - eye);
    const Vec3d upwards = unit_vector(name, "upward direction", up);
    const Vec3d sideways = cross(forward, upwards);
    if (length(sideways) < 1e-9) refuse_region(name, "its upward direction is parallel to the direction of view");
    const Vec3d right = unit_vector(name, "upward direction", sideways), above = cross(right, forward);
    const double rise = std::tan(view_angle / 360 * pi), run = rise * aspect;
    if (!std::isfinite(run) || !(run > 0)) refuse_region(name, "its aspect is out of range");
    std::vector<Plane> planes{{forward, -near}, {-1.0 * forward, far}};
    for (const double sign : {1.0, -1.0})
        for (const auto& [side, slope] : {std::pair{right, run}, std::pair{above, rise}}) {
            // side . d <= slope * forward . d, and the same for the opposite side
            planes.push_back({slope * forward - sign * side, 0});
        }
    return convex(eye, planes);
}

Region Region::prism(const Vec3d& centre, const Vec3d& axis_u, const Vec3d& axis_v, const std::vector<Vec2d>& polygon)
{
    const std::string name = "polygon";
    require_finite(name, "centre", centre);
    const Vec3d u = unit_vector(name, "axis", axis_u), given = unit_vector(name, "axis", axis_v);
    if (std::fabs(dot(u, given)) > 1e-6)
        refuse_region(name,
                      "its axes" + pcm::text_of({axis_u}) + " and" + pcm::text_of({axis_v}) + " are not perpendicular");
    const double lean = dot(u, given);
    const Vec3d v = lean == 0 ? given : unit_vector(name, "axis", given - lean * u);
    Region region;
    region.kind_ = Kind::polygon;
    region.centre_ = centre;
    region.polygon_ = std::make_shared<const Polygon>(polygon_of(name, polygon));
    region.rows_ = {Plane{u, 0}, Plane{v, 0}, Plane{{}, 1}};
    const Vec2d &low = region.polygon_->min(), &high = region.polygon_->max();
    for (std::size_t k = 0; k < 2; ++k) {
        // Comparisons with the ends: the sign of a rounded sum is exact.
        region.planes_.push_back({region.rows_[k].normal, -low[k]});
        region.planes_.push_back({-1.0 * region.rows_[k].normal, high[k]});
    }
    region.bound_prism();
    const bool in_plan = centre == Vec3d{} && axis_u == Vec3d{1, 0, 0} && axis_v == Vec3d{0, 1, 0};
    region.text_ = (in_plan ? "polygon" : "prism" + pcm::text_of({centre, axis_u, axis_v})) + text_of(polygon);
    return region;
}

Region Region::lasso(const std::array<double, 16>& modelview, const std::array<double, 16>& projection,
                     const Vec3d& origin, const std::vector<Vec2d>& polygon)
{
    const std::string name = "lasso";
    const ViewFrame frame = view_frame(name, modelview, projection, origin);
    Region region;
    region.kind_ = Kind::polygon;
    region.centre_ = frame.centre;
    region.polygon_ = std::make_shared<const Polygon>(polygon_of(name, polygon));
    const auto row = [&](std::size_t r) {
        Plane plane{{}, projection[12 + r]};
        for (std::size_t k = 0; k < 3; ++k) plane.normal = plane.normal + projection[k * 4 + r] * frame.rows[k];
        plane.offset -= dot(plane.normal, frame.rest);
        return plane;
    };
    const Plane z = row(2), w = row(3);
    region.rows_ = {row(0), row(1), w};
    // w + factor * plane >= 0
    const auto add = [&](const Plane& first, double factor, const Plane& second) {
        const Plane plane{first.normal + factor * second.normal, first.offset + factor * second.offset};
        if (largest_magnitude(plane.normal) > 0)
            region.add_plane(name, plane);
        else if (!(plane.offset >= 0))
            refuse_region(name, "its projection shows nothing");
    };
    add(w, 1, z);
    add(w, -1, z);
    for (std::size_t k = 0; k < 2; ++k) {
        // Rounded outwards: these only bound what the polygon decides.
        const double low = region.polygon_->min()[k], high = region.polygon_->max()[k];
        const double slack = 1e-12 * std::max(std::fabs(low), std::fabs(high));
        const Plane& across = region.rows_[k];
        if (largest_magnitude(across.normal) == 0) refuse_region(name, "its projection is singular");
        add(across, -(low - slack), w);
        add({-1.0 * across.normal, -across.offset}, high + slack, w);
    }
    region.bound_by_planes();
    region.view_ = std::make_shared<const View>(View{modelview, projection, origin, polygon});
    region.text_ = "lasso" + text_of(modelview) + text_of(projection) + pcm::text_of({origin}) + text_of(polygon);
    return region;
}

// A prism is unbounded along the third direction, so an axis of the source is bounded only where it lies in the plane
// of the polygon: where u or v is that axis, or both are perpendicular to one and the same axis.
void Region::bound_prism()
{
    Vec3d low, high;
    low.fill(-infinity);
    high.fill(infinity);
    const Vec3d &u = rows_[0].normal, &v = rows_[1].normal;
    const Vec2d &from = polygon_->min(), &to = polygon_->max();
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        bool flat = false;
        for (const std::size_t normal : {b, c}) flat = flat || (u[normal] == 0 && v[normal] == 0);
        const bool along_u = u[b] == 0 && u[c] == 0, along_v = v[b] == 0 && v[c] == 0;
        if (!flat && !along_u && !along_v) continue;
        double margin = 0, ends[2] = {0, 0};
        for (std::size_t k = 0; k < 2; ++k) {
            const double part = rows_[k].normal[a];
            if ((along_u && k == 1) || (along_v && k == 0)) continue;
            ends[0] += std::min(part * from[k], part * to[k]);
            ends[1] += std::max(part * from[k], part * to[k]);
            margin += std::max(std::fabs(from[k]), std::fabs(to[k]));
        }
        low[a] = ends[0] - 1e-12 * margin;
        high[a] = ends[1] + 1e-12 * margin;
    }
    set_bounds(low, high);
}

// The largest e . d of an axis direction e over the region. With multipliers m >= 0 and r = e + sum m_i n_i, each d
// inside has e . d <= sum m_i offset_i + r . d. Three planes and the multipliers that make r vanish give the smallest
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
                                rounding += 4 * unit_roundoff * multiplier * std::fabs(three[m]->normal[a]);
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

}  // namespace pcm
