#include "bench/fit/fit_scene.h"

#include "pcm/fit/shape_fit.h"

#include <algorithm>
#include <random>

namespace pcm::bench {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }
double between(Random& random, double low, double high) { return low + (high - low) * uniform(random); }
double gaussian(Random& random)
{
    const double r = std::sqrt(-2 * std::log(1 - uniform(random)));
    return r * std::cos(2 * pi * uniform(random));
}

Vec3d direction(Random& random)
{
    const double z = between(random, -1, 1), a = between(random, 0, 2 * pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
}

// A place of the truth and its normal, of a shape whose axis is `axes[2]` and that stands at `truth.point`.
struct Place {
    Vec3d p, n;
};
Place place_on(const FitSceneOptions& o, const Shape& truth, const std::array<Vec3d, 3>& axes, Random& random)
{
    const auto local = [&](double x, double y, double z) { return x * axes[0] + y * axes[1] + z * axes[2]; };
    if (o.kind == ShapeKind::plane) {
        const double x = between(random, -0.5, 0.5) * o.size, y = between(random, -0.5, 0.5) * o.size;
        return {truth.point + local(x, y, 0), axes[2]};
    }
    if (o.kind == ShapeKind::sphere) {
        // Even on the sphere: the height along the axis is even.
        const double least = o.patch > 0 ? std::cos(std::asin(std::min(1.0, 0.5 * o.patch / o.radius))) : -1;
        // 1 - z keeps its digits where the part is small relative to the sphere.
        const double down = uniform(random) * (o.patch > 0 ? 1 - least : 2), z = 1 - down;
        const double r = std::sqrt(std::max(0.0, down * (2 - down))), a = between(random, 0, 2 * pi);
        const Vec3d n = local(r * std::cos(a), r * std::sin(a), z);
        return {truth.point + o.radius * n, n};
    }
    const double a = between(random, -0.5, 0.5) * o.arc;
    const Vec3d out = local(std::cos(a), std::sin(a), 0);
    if (o.kind == ShapeKind::cylinder)
        return {truth.point + o.radius * out + (between(random, -0.5, 0.5) * o.size) * axes[2], out};
    // A cone cut off at half its height: as wide as `radius` at `size`; even on it.
    const double h = o.size * std::sqrt(between(random, 0.25, 1)), slope = std::tan(truth.second);
    const double c = std::cos(truth.second), s = std::sin(truth.second);
    return {truth.point + h * axes[2] + (h * slope) * out, c * out - s * axes[2]};
}

}  // namespace

FitScene make_scene(const FitSceneOptions& options)
{
    Random random(options.seed * 0x9e3779b97f4a7c15u + 12345);
    for (int i = 0; i < 16; ++i) random();
    FitScene scene;
    scene.options = options;
    Shape& truth = scene.truth;
    truth.kind = options.kind;
    truth.axis = direction(random);
    truth.radius = options.radius;
    if (options.kind == ShapeKind::cone) truth.second = std::atan2(options.radius, options.size);
    const Vec3d other = direction(random), x = normalised(cross(truth.axis, other));
    const std::array<Vec3d, 3> axes{x, cross(truth.axis, x), truth.axis};
    // Not at the offset itself: nothing may come out right because it is 0. Parts of large shapes stay near it.
    Vec3d about{between(random, -3, 3), between(random, -3, 3), between(random, -3, 3)};
    if (options.kind == ShapeKind::sphere && options.patch > 0) about = about - options.radius * truth.axis;
    if (options.kind == ShapeKind::cylinder && options.arc < pi) about = about - options.radius * axes[0];
    truth.point = about;

    std::vector<Vec3d> points;
    const auto outliers =
        static_cast<std::size_t>(std::llround(options.outliers * static_cast<double>(options.points)));
    Vec3d low{}, high{};
    for (std::size_t i = 0; i + outliers < options.points; ++i) {
        const Place place = place_on(options, truth, axes, random);
        points.push_back(place.p + (options.sigma * gaussian(random)) * place.n);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = i == 0 ? points[0][k] : std::min(low[k], points[i][k]);
            high[k] = i == 0 ? points[0][k] : std::max(high[k], points[i][k]);
        }
    }
    const Vec3d room = 0.05 * (high - low);
    for (std::size_t i = 0; i < outliers; ++i) {
        Vec3d p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = between(random, low[k] - room[k], high[k] + room[k]);
        points.push_back(p);
    }
    for (int i = 0; i < 400; ++i) scene.surface.push_back(options.offset + place_on(options, truth, axes, random).p);
    for (const Vec3d& p : scene.surface) scene.middle = scene.middle + (p - scene.surface[0]) / 400;
    scene.middle = scene.middle + scene.surface[0];

    std::vector<std::size_t> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Vec3d> shuffled;
    for (const std::size_t i : order) {
        shuffled.push_back(options.offset + points[i]);
        scene.on_shape.push_back(i + outliers < options.points);
    }
    truth.point = options.offset + truth.point;
    scene.points = FitPoints::of(shuffled);
    if (options.with_normals) estimate_normals(scene.points);
    return scene;
}

FitError error_of(const FitScene& scene, const Shape& found)
{
    FitError error;
    const Shape& truth = scene.truth;
    for (const Vec3d& p : scene.surface) error.surface += std::pow(signed_distance(found, p), 2);
    error.surface = std::sqrt(error.surface / static_cast<double>(scene.surface.size()));
    if (truth.kind != ShapeKind::sphere)
        error.angle = std::atan2(length(cross(truth.axis, found.axis)), std::fabs(dot(truth.axis, found.axis)));
    const Vec3d d = scene.middle - truth.point;
    // The place of the truth's axis that is nearest to the middle, seen from the found one.
    const Vec3d on_axis = truth.point + dot(d, truth.axis) * truth.axis;
    if (truth.kind == ShapeKind::plane)
        error.position = distance_to(found, on_axis + (d - dot(d, truth.axis) * truth.axis));
    if (truth.kind == ShapeKind::cylinder) error.position = length(cross(found.axis, on_axis - found.point));
    if (truth.kind == ShapeKind::sphere || truth.kind == ShapeKind::cone)
        error.position = length(truth.point - found.point);
    error.radius = std::fabs(truth.kind == ShapeKind::cone ? found.second - truth.second : found.radius - truth.radius);
    if (truth.kind == ShapeKind::plane) error.radius = 0;
    return error;
}

}  // namespace pcm::bench
