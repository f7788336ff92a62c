#include "pcm/measure/polygon.h"

#include "pcm/cloud/exact_products.h"

#include <algorithm>

namespace pcm {
namespace {

bool in_box(const Vec2d& a, const Vec2d& b, const Vec2d& p)
{
    for (std::size_t k = 0; k < 2; ++k)
        if (p[k] < std::min(a[k], b[k]) || p[k] > std::max(a[k], b[k])) return false;
    return true;
}

int sign(double value) { return (value > 0) - (value < 0); }

// Ends included.
bool meet(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d)
{
    for (std::size_t k = 0; k < 2; ++k)
        if (std::max(a[k], b[k]) < std::min(c[k], d[k]) || std::max(c[k], d[k]) < std::min(a[k], b[k])) return false;
    const int abc = sign(turn(a, b, c)), abd = sign(turn(a, b, d));
    const int cda = sign(turn(c, d, a)), cdb = sign(turn(c, d, b));
    if (abc * abd < 0 && cda * cdb < 0) return true;
    return (abc == 0 && in_box(a, b, c)) || (abd == 0 && in_box(a, b, d)) || (cda == 0 && in_box(c, d, a)) ||
           (cdb == 0 && in_box(c, d, b));
}

// Whether b-c runs back on a-b.
bool folds(const Vec2d& a, const Vec2d& b, const Vec2d& c)
{
    return turn(a, b, c) == 0 && (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0;
}

}  // namespace

double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c)
{
    return difference_of_products(b[0] - a[0], c[1] - a[1], b[1] - a[1], c[0] - a[0]);
}

Vec3d vector_area(const std::vector<Vec3d>& polygon)
{
    // Knuth's two-sum for each coordinate: parts of a polygon far from its first point cancel.
    Vec3d sum{}, error{};
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const Vec3d part = exact_cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            const double next = sum[k] + part[k], back = next - sum[k];
            error[k] += (sum[k] - (next - back)) + (part[k] - back);
            sum[k] = next;
        }
    }
    return 0.5 * (sum + error);
}

std::optional<EdgePair> find_crossing(const std::vector<Vec2d>& polygon)
{
    const std::size_t count = polygon.size();
    if (count < 3) return {};
    const auto point = [&](std::size_t i) -> const Vec2d& { return polygon[i % count]; };
    for (std::size_t i = 0; i < count; ++i)
        if (folds(point(i), point(i + 1), point(i + 2))) return EdgePair{i, (i + 1) % count};
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 2; j < count; ++j)
            if ((i != 0 || j + 1 != count) && meet(point(i), point(i + 1), point(j), point(j + 1)))
                return EdgePair{i, j};
    return {};
}

std::vector<Vec3d> without_repeats(const std::vector<Vec3d>& polygon)
{
    std::vector<Vec3d> points;
    for (const Vec3d& p : polygon)
        if (points.empty() || p != points.back()) points.push_back(p);
    while (points.size() > 1 && points.front() == points.back()) points.pop_back();
    return points;
}

std::vector<Vec2d> in_plan(const std::vector<Vec3d>& polygon)
{
    std::vector<Vec2d> flat;
    for (const Vec3d& p : polygon) flat.push_back({p[0], p[1]});
    return flat;
}

std::vector<Vec2d> seen_along(const std::vector<Vec3d>& polygon, const Vec3d& normal)
{
    // The axis that the normal is least along gives two that are well perpendicular to it.
    std::size_t least = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (std::fabs(normal[k]) < std::fabs(normal[least])) least = k;
    Vec3d axis{};
    axis[least] = 1;
    const Vec3d u = normalised(cross(axis, normal)), v = cross(normal, u);
    std::vector<Vec2d> flat;
    for (const Vec3d& p : polygon) flat.push_back({exact_dot(u, p - polygon[0]), exact_dot(v, p - polygon[0])});
    return flat;
}

}  // namespace pcm
