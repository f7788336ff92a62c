#include "pcm/detect/local_surface.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/models/shape_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t least_points = 8;

Vector6 row_of(double x, double y)
{
    Vector6 row;
    row << 1, x, y, 0.5 * x * x, x * y, 0.5 * y * y;
    return row;
}

struct Solution {
    Vector6 values = Vector6::Zero();
    double curvature_variance = 0;  // for unit noise
};

// The points of `flat` (x, y, z in units of the extent) up to `limit` from `from`.
std::optional<Solution> solve(const std::vector<Vec3d>& flat, const Vector6& from, double limit, std::size_t& used)
{
    Matrix6 normal = Matrix6::Zero();
    Vector6 right = Vector6::Zero();
    used = 0;
    for (const Vec3d& p : flat) {
        const Vector6 row = row_of(p[0], p[1]);
        if (std::fabs(p[2] - row.dot(from)) > limit) continue;
        normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
        right += p[2] * row;
        ++used;
    }
    if (used < least_points) return std::nullopt;
    const Eigen::LDLT<Matrix6, Eigen::Lower> factors(normal);
    const auto diagonal = factors.vectorD();
    if (factors.info() != Eigen::Success || !(diagonal.minCoeff() > 1e-9 * diagonal.maxCoeff())) return std::nullopt;
    Solution solution;
    solution.values = factors.solve(right);
    Vector6 unit = Vector6::Zero();
    for (const int k : {3, 5}) {
        unit.setZero();
        unit[k] = 1;
        solution.curvature_variance = std::max(solution.curvature_variance, factors.solve(unit)[k]);
    }
    return solution;
}

void set_frame(LocalSurface& surface, const Vec3d& normal)
{
    surface.z = normal;
    const Vec3d other = std::fabs(normal[2]) < 0.8 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
    surface.x = normalised(cross(other, normal));
    surface.y = cross(normal, surface.x);
}

}  // namespace

std::optional<LocalSurface> fit_local_surface(const SurfaceSample& sample, const std::uint32_t* points,
                                              std::size_t count, double threshold)
{
    if (count < least_points) return std::nullopt;
    LocalSurface surface;
    surface.place = sample.at[points[0]];
    const Vec3d normal = sample.normal_of(points[0]);
    if (dot(normal, normal) < 0.5) return std::nullopt;
    set_frame(surface, normalised(normal));
    std::vector<Vec3d> flat(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d d = sample.at[points[i]] - surface.place;
        flat[i] = {dot(d, surface.x), dot(d, surface.y), dot(d, surface.z)};
        surface.extent = std::max(surface.extent, std::hypot(flat[i][0], flat[i][1]));
    }
    const double size = surface.extent;
    if (!(size > 0) || !std::isfinite(size)) return std::nullopt;
    for (Vec3d& p : flat) p = p / size;
    std::size_t used = 0;
    const auto first = solve(flat, Vector6::Zero(), infinity, used);
    if (!first) return std::nullopt;
    const auto second = solve(flat, first->values, threshold / size, used);
    if (!second) return std::nullopt;
    const Vector6& c = second->values;
    double squares = 0;
    std::size_t near = 0;
    for (const Vec3d& p : flat) {
        const double d = p[2] - row_of(p[0], p[1]).dot(c);
        if (std::fabs(d) * size > threshold) continue;
        squares += d * d;
        ++near;
    }
    surface.rms = near > 6 ? size * std::sqrt(squares / static_cast<double>(near - 6)) : 0;
    surface.near = static_cast<double>(near) / static_cast<double>(count);
    surface.curvature_error = surface.rms * std::sqrt(second->curvature_variance) / (size * size);
    surface.c0 = c[0] * size, surface.c1 = c[1], surface.c2 = c[2];
    surface.xx = c[3] / size, surface.xy = c[4] / size, surface.yy = c[5] / size;
    return surface;
}

std::vector<Shape> shapes_like(const LocalSurface& surface, const std::vector<ShapeKind>& kinds)
{
    const Vec3d top = surface.place + surface.c0 * surface.z;
    const Vec3d up = normalised(surface.z - surface.c1 * surface.x - surface.c2 * surface.y);
    // Principal curvatures k1, k2 with |k1| >= |k2|, and the direction of k2.
    const double mean = 0.5 * (surface.xx + surface.yy), half = 0.5 * (surface.xx - surface.yy);
    const double spread = std::hypot(half, surface.xy), angle = 0.5 * std::atan2(surface.xy, half);
    double k1 = mean + spread, k2 = mean - spread, towards = angle + pi / 2;
    if (std::fabs(k2) > std::fabs(k1)) {
        std::swap(k1, k2);
        towards = angle;
    }
    const Vec3d along = std::cos(towards) * surface.x + std::sin(towards) * surface.y;
    SurfaceBend bend;
    bend.place = top;
    bend.up = up;
    bend.straight = normalised(along - dot(along, up) * up);
    bend.k1 = k1;
    bend.k2 = k2;
    bend.steepness = 1 + surface.c1 * surface.c1 + surface.c2 * surface.c2;
    bend.doubt = 4 * surface.curvature_error;
    std::vector<Shape> shapes;
    for (const ShapeKind kind : kinds) {
        Shape shape;
        const auto like = model_of(kind).like;
        if (like && like(bend, shape)) shapes.push_back(shape);
    }
    return shapes;
}

}  // namespace pcm
