#include "pcm/fit/ray_errors.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/least_squares.h"
#include "pcm/fit/tuning.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace pcm {
namespace {

constexpr int share_steps = 10;
constexpr std::size_t least_points = 24;  // minimum number of a station's points that show the direction of its rays

struct OnShape {
    Vec3d place{}, normal{};  // in units of the extent, about the middle
    double distance = 0;
};

// The points of a station, without the shift of the station.
struct Rays {
    std::vector<OnShape> points;
    Vec3d direction{};

    bool set_direction()
    {
        Vec3d sum{};
        for (const OnShape& p : points) sum = sum + p.normal;
        const double size = length(sum);
        if (points.size() < least_points ||
            !(size > fit_tuning().ray_errors.min_mean_normal * static_cast<double>(points.size())))
            return false;
        direction = (1 / size) * sum;
        return true;
    }

    void take_away_shift()
    {
        Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
        Eigen::Vector3d pulls = Eigen::Vector3d::Zero();
        for (const OnShape& p : points) {
            const Eigen::Vector3d n(p.normal[0], p.normal[1], p.normal[2]);
            products += n * n.transpose();
            pulls += p.distance * n;
        }
        products.diagonal().array() += 1e-3 * products.trace();  // directions that no normal has
        const Eigen::Vector3d shift = products.ldlt().solve(pulls);
        for (OnShape& p : points)
            p.distance -= p.normal[0] * shift[0] + p.normal[1] * shift[1] + p.normal[2] * shift[2];
    }

    double variance_at(const OnShape& p, double share) const
    {
        const double along = dot(p.normal, direction);
        return 1 - share + share * std::max(along * along, fit_tuning().ray_errors.min_along);
    }

    // s^2 of the most probable one.
    double scale(double share) const
    {
        double sum = 0;
        for (const OnShape& p : points) sum += p.distance * p.distance / variance_at(p, share);
        return sum / static_cast<double>(points.size());
    }

    // Twice the negative logarithm of the likelihood, without its constant.
    double misfit(double share) const
    {
        double sum = static_cast<double>(points.size()) * std::log(std::max(scale(share), 1e-300));
        for (const OnShape& p : points) sum += std::log(variance_at(p, share));
        return sum;
    }
};

// 0 where the most probable one is hardly more probable than that.
double most_probable_share(const std::map<std::uint32_t, Rays>& stations)
{
    const auto misfit = [&](double share) {
        double sum = 0;
        for (const auto& [station, rays] : stations) sum += rays.misfit(share);
        return sum;
    };
    double best = 0, least = misfit(0) - 2 * fit_tuning().ray_errors.min_evidence;
    for (int k = 1; k <= share_steps; ++k) {
        const double share = static_cast<double>(k) / share_steps, sum = misfit(share);
        if (sum < least) best = share;
        least = std::min(least, sum);
    }
    return best;
}

using Gradient = std::array<double, most_parameters>;

// Adds a point to the normal equations, and what its errors add to their right side: half the second derivative of its
// distance along the rays times J, and the derivative of J along them times that of the distance.
void add_point(const ShapeModel& model, const SurfacePatch& patch, const Vec3d& place, const Vec3d& direction,
               double variance, double step, PatchSums& sums, Gradient& bias)
{
    std::array<std::array<double, 3>, 3> at{};  // coordinates of the place, a step before and a step after it
    for (std::size_t a = 0; a < 3; ++a)
        at[a] = {place[a], place[a] - step * direction[a], place[a] + step * direction[a]};
    PatchBlock seen;
    model.differentiate(patch, at[0].data(), at[1].data(), at[2].data(), 3, seen);
    add_to(sums, seen, 0);
    const double bend = (seen.distance[1] + seen.distance[2] - 2 * seen.distance[0]) / (step * step);
    const double slope = (seen.distance[2] - seen.distance[1]) / (2 * step);
    for (std::size_t j = 0; j < model.parameters(); ++j) {
        const double turn = (seen.by[j][2] - seen.by[j][1]) / (2 * step);
        bias[j] += variance * (seen.by[j][0] * bend / 2 + turn * slope);
    }
}

std::map<std::uint32_t, Rays> rays_of(const Shape& shape, const std::vector<PointOfStation>& points,
                                      const Vec3d& middle, double extent)
{
    std::map<std::uint32_t, Rays> stations;
    for (const PointOfStation& p : points)
        stations[p.station].points.push_back(
            {(1 / extent) * (p.place - middle), normal_at(shape, p.place), signed_distance(shape, p.place) / extent});
    for (auto station = stations.begin(); station != stations.end();) {
        if (station->second.set_direction()) {
            station->second.take_away_shift();
            ++station;
        } else {
            station = stations.erase(station);
        }
    }
    return stations;
}

}  // namespace

std::optional<WithoutRayErrors> without_ray_errors(const Shape& shape, const std::vector<PointOfStation>& points,
                                                   const Vec3d& middle, double extent)
{
    const ShapeModel& model = model_of(shape.kind);
    if (model.traits.is_flat() || points.empty() || !(extent > 0)) return {};
    const std::map<std::uint32_t, Rays> stations = rays_of(shape, points, middle, extent);
    WithoutRayErrors result;
    if (stations.empty() || !((result.share = most_probable_share(stations)) > 0)) return {};
    const SurfacePatch patch = model.patch_at(scaled(shape, middle, extent), {});
    const double step = 0.01 * std::min(narrowest_radius(shape) / extent, 0.01);
    PatchSums sums;
    sums.parameters = model.parameters();
    Gradient bias{};
    for (const auto& [station, rays] : stations) {
        const double variance = result.share * rays.scale(result.share);
        for (const OnShape& p : rays.points)
            add_point(model, patch, p.place, rays.direction, variance, step, sums, bias);
    }
    for (std::size_t j = 0; j < bias.size(); ++j) sums.gradient[j] = -bias[j];
    Gradient by{};
    if (!step_of(model, sums, 1, 0, by)) return {};
    const Shape moved = model.shape_of(model.moved(patch, by.data()));
    if (!is_proper(moved)) return {};
    result.shape = unscaled(moved, middle, extent);
    return result;
}

}  // namespace pcm
