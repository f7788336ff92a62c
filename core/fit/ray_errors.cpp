#include "pcm/fit/ray_errors.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/beam_width.h"
#include "pcm/fit/least_squares.h"
#include "pcm/fit/station_rays.h"
#include "pcm/fit/tuning.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace pcm {
namespace {

constexpr int share_steps = 10;

// Distances of a station's points, without its shift.
std::vector<double> without_shift(const StationRays& rays)
{
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    Eigen::Vector3d pulls = Eigen::Vector3d::Zero();
    for (const PointOnShape& p : rays.points) {
        const Eigen::Vector3d n(p.normal[0], p.normal[1], p.normal[2]);
        products += n * n.transpose();
        pulls += p.distance * n;
    }
    products.diagonal().array() += 1e-3 * products.trace();  // directions that no normal has
    const Eigen::Vector3d shift = products.ldlt().solve(pulls);
    std::vector<double> distances;
    for (const PointOnShape& p : rays.points)
        distances.push_back(p.distance - p.normal[0] * shift[0] - p.normal[1] * shift[1] - p.normal[2] * shift[2]);
    return distances;
}

// How the distances of a station's points vary with the angle of its rays.
class RayVariance {
public:
    explicit RayVariance(const StationRays& rays)
    {
        for (const double d : without_shift(rays)) squares_.push_back(d * d);
        for (const PointOnShape& p : rays.points) {
            const double along = dot(p.normal, rays.direction);
            along_.push_back(std::max(along * along, fit_tuning().ray_errors.min_along));
        }
    }

    // s^2 of the most probable one.
    double scale(double share) const
    {
        double sum = 0;
        for (std::size_t i = 0; i < squares_.size(); ++i) sum += squares_[i] / variance_at(i, share);
        return sum / static_cast<double>(squares_.size());
    }

    // Twice the negative logarithm of the likelihood, without its constant.
    double misfit(double share) const
    {
        double sum = static_cast<double>(squares_.size()) * std::log(std::max(scale(share), 1e-300));
        for (std::size_t i = 0; i < squares_.size(); ++i) sum += std::log(variance_at(i, share));
        return sum;
    }

private:
    double variance_at(std::size_t i, double share) const { return 1 - share + share * along_[i]; }

    std::vector<double> squares_, along_;
};

// 0 where the most probable one is hardly more probable than that.
double most_probable_share(const std::vector<RayVariance>& stations)
{
    const auto misfit = [&](double share) {
        double sum = 0;
        for (const RayVariance& station : stations) sum += station.misfit(share);
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

// The shape that these pulls, added to the right side of the normal equations, have moved, moved back.
std::optional<Shape> moved_back(const ShapeModel& model, const SurfacePatch& patch, PatchSums sums,
                                const Gradient& pulls)
{
    for (std::size_t j = 0; j < pulls.size(); ++j) sums.gradient[j] = -pulls[j];
    Gradient by{};
    if (!step_of(model, sums, 1, 0, by)) return {};
    const Shape moved = model.shape_of(model.moved(patch, by.data()));
    if (!is_proper(moved)) return {};
    return moved;
}

}  // namespace

std::optional<WithoutRayErrors> without_ray_errors(const Shape& shape, const std::vector<PointOfStation>& points,
                                                   const Vec3d& middle, double extent, double widest_beam)
{
    const ShapeModel& model = model_of(shape.kind);
    if (model.traits.is_flat() || points.empty() || !(extent > 0)) return {};
    std::map<std::uint32_t, StationRays> stations = rays_of(shape, points, middle, extent);
    std::vector<RayVariance> variances;
    for (const auto& [station, rays] : stations) variances.emplace_back(rays);
    WithoutRayErrors result;
    if (stations.empty() || !((result.share = most_probable_share(variances)) > 0)) return {};
    const SurfacePatch patch = model.patch_at(scaled(shape, middle, extent), {});
    const double step = 0.01 * std::min(narrowest_radius(shape) / extent, 0.01);
    PatchSums sums;
    sums.parameters = model.parameters();
    Gradient noise{};
    auto variance = variances.begin();
    for (auto& [station, rays] : stations) {
        rays.noise = result.share * (variance++)->scale(result.share);
        for (const PointOnShape& p : rays.points)
            add_point(model, patch, p.place, rays.direction, rays.noise, step, sums, noise);
    }
    const BeamWidth beam = beam_width(model, patch, stations, widest_beam / extent, step);
    const auto pulls = [&](double beam_variance) {
        Gradient all = noise;
        for (std::size_t j = 0; j < all.size(); ++j) all[j] += beam_variance * beam.pulls[j];
        return all;
    };
    const auto freed = moved_back(model, patch, sums, pulls(beam.variance));
    const auto wider = moved_back(model, patch, sums, pulls(beam.variance + beam.error));
    if (!freed || !wider) return {};
    result.beam = std::sqrt(beam.variance) * extent;
    result.shape = unscaled(*freed, middle, extent);
    result.of_wider_beam = unscaled(*wider, middle, extent);
    return result;
}

}  // namespace pcm
