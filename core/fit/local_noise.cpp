// The threshold that points' own noise asks for.
#include "pcm/cloud/numbers.h"
#include "pcm/fit/near_tree.h"
#include "pcm/fit/random_numbers.h"
#include "pcm/fit/second_degree.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/fit/tuning.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcm {
namespace {

constexpr std::size_t most_places = 200, least_neighbours = 16, most_neighbours = 512;

using Vector6 = Eigen::Matrix<double, surface_numbers, 1>;
using Matrix6 = Eigen::Matrix<double, surface_numbers, surface_numbers>;

// The neighbours in axes of the plane through them; heights are along its normal. In units of the neighbourhood.
struct Patch {
    std::vector<Vector6> rows;
    std::vector<double> heights, residuals, sizes;
    std::vector<bool> used;
};

void set_axes(const std::vector<Eigen::Vector3d>& offsets, Patch& patch)
{
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double count = 0;
    for (std::size_t i = 0; i < offsets.size(); ++i)
        if (patch.used[i]) {
            middle += offsets[i];
            count += 1;
        }
    middle /= count;
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < offsets.size(); ++i)
        if (patch.used[i]) products += (offsets[i] - middle) * (offsets[i] - middle).transpose();
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(products).eigenvectors();
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const Eigen::Vector3d t = axes.transpose() * (offsets[i] - middle);
        patch.rows[i] << 1, t[1], t[2], t[1] * t[1], t[1] * t[2], t[2] * t[2];
        patch.heights[i] = t[0];
    }
}

// Least-squares fit to the used points; returns the deviation of their residuals, below 0 for too few.
double fit_surface(Patch& patch)
{
    Matrix6 a = 1e-12 * Matrix6::Identity();
    Vector6 b = Vector6::Zero();
    std::size_t count = 0;
    for (std::size_t i = 0; i < patch.rows.size(); ++i)
        if (patch.used[i]) {
            a += patch.rows[i] * patch.rows[i].transpose();
            b += patch.rows[i] * patch.heights[i];
            ++count;
        }
    if (count < surface_numbers + 4) return -1;
    const Vector6 x = a.ldlt().solve(b);
    double squares = 0;
    for (std::size_t i = 0; i < patch.rows.size(); ++i) {
        patch.residuals[i] = patch.heights[i] - patch.rows[i].dot(x);
        if (patch.used[i]) squares += patch.residuals[i] * patch.residuals[i];
    }
    return std::sqrt(squares / static_cast<double>(count - surface_numbers));
}

// Standard deviation of the points from a curved surface through most of them, in units of the neighbourhood; below 0:
// unknown.
double noise_of(const std::vector<Eigen::Vector3d>& offsets, Patch& patch)
{
    const std::size_t n = offsets.size();
    patch.rows.resize(n);
    patch.heights.resize(n);
    patch.residuals.resize(n);
    patch.used.assign(n, true);
    double noise = -1;
    for (int round = 0; round < 4; ++round) {
        if (round < 3) set_axes(offsets, patch);
        noise = fit_surface(patch);
        if (noise < 0) return noise;
        patch.sizes.assign(n, 0);
        for (std::size_t i = 0; i < n; ++i) patch.sizes[i] = std::fabs(patch.residuals[i]);
        std::nth_element(patch.sizes.begin(), patch.sizes.begin() + n / 2, patch.sizes.end());
        const double limit = fit_tuning().thresholds.residual_cut * 1.4826 * patch.sizes[n / 2] *
                             std::sqrt(static_cast<double>(n) / static_cast<double>(n - surface_numbers));
        for (std::size_t i = 0; i < n; ++i) patch.used[i] = std::fabs(patch.residuals[i]) <= limit;
    }
    return noise;
}

// The noise around some of the points [0, n) in random order.
std::vector<double> noises(const FitPoints& points, const std::vector<std::uint32_t>& order, std::size_t n)
{
    std::vector<double> x, y, z, found;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d p = points.at(order[i]);
        x.push_back(p[0]);
        y.push_back(p[1]);
        z.push_back(p[2]);
    }
    const NearTree tree(x, y, z);
    std::vector<NearTree::Near> near;
    std::vector<Eigen::Vector3d> offsets;
    Patch patch;
    for (std::size_t i = 0; i < std::min(most_places, n); ++i) {
        const Vec3d place = points.at(order[i]);
        for (std::size_t k = least_neighbours; k <= std::min(most_neighbours, n); k *= 2) {
            tree.nearest(place, k, near);
            const double size = std::sqrt(near.back().square);
            if (!(size > 0)) continue;
            offsets.clear();
            for (const NearTree::Near& one : near) {
                const Vec3d d = (Vec3d{x[one.index], y[one.index], z[one.index]} - place) / size;
                offsets.emplace_back(d[0], d[1], d[2]);
            }
            const double noise = noise_of(offsets, patch);
            if (noise < 0 || noise > fit_tuning().thresholds.max_local_noise) continue;
            found.push_back(noise * size);
            break;
        }
    }
    return found;
}

// Where they are densest in proportion: places among outliers show more noise, in a wide range.
double mode_of(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const std::size_t part = std::max<std::size_t>(1, values.size() / 3);
    std::size_t best = 0;
    double least = infinity;
    for (std::size_t i = 0; i + part <= values.size(); ++i) {
        const double ratio = values[i] > 0 ? values[i + part - 1] / values[i] : values[i + part - 1] > 0 ? least : 1;
        if (ratio < least) {
            least = ratio;
            best = i;
        }
    }
    return values[best + part / 2];
}

}  // namespace

double automatic_threshold(const FitPoints& points)
{
    if (!is_finite(points.origin)) return 0;
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    SampleNumbers random(1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_finite(points.at(i))) return 0;
        std::swap(order[i], order[i + random.below(points.size() - i)]);
    }
    // Dense points with much noise show it in a part of them, whose neighbourhoods are wider.
    for (std::size_t n = points.size(); n >= least_neighbours; n /= 4) {
        const std::vector<double> found = noises(points, order, n);
        if (found.size() * 5 >= std::min(most_places, n)) return fit_tuning().thresholds.inlier_noises * mode_of(found);
    }
    return 0;
}

}  // namespace pcm
