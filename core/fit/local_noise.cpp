// The threshold that points' own noise asks for.
#include "pcm/fit/near_tree.h"
#include "pcm/fit/random_numbers.h"
#include "pcm/fit/shape_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t places = 400, neighbours = 24, surface_numbers = 6;

// Standard deviation of the nearest points from a curved surface through them; below 0: unknown.
double noise_near(const FitPoints& points, const std::vector<NearTree::Near>& near)
{
    const double size = near.empty() ? 0 : std::sqrt(near.back().square);
    if (near.size() < surface_numbers + 3 || !(size > 0)) return -1;
    const Vec3d place = points.at(near.front().index);
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> offsets;
    for (const NearTree::Near& one : near) {
        const Vec3d d = (points.at(one.index) - place) / size;
        offsets.emplace_back(d[0], d[1], d[2]);
        middle += offsets.back();
    }
    middle /= static_cast<double>(near.size());
    for (const Eigen::Vector3d& v : offsets) products += (v - middle) * (v - middle).transpose();
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(products).eigenvectors();
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> a = 1e-12 * Eigen::Matrix<double, 6, 6>::Identity();
    Vector6 b = Vector6::Zero();
    double squares = 0;
    for (const Eigen::Vector3d& v : offsets) {
        const Eigen::Vector3d t = axes.transpose() * (v - middle);
        Vector6 row;
        row << 1, t[1], t[2], t[1] * t[1], t[1] * t[2], t[2] * t[2];
        a += row * row.transpose();
        b += row * t[0];
        squares += t[0] * t[0];
    }
    const double rest = squares - b.dot(a.ldlt().solve(b));
    return size * std::sqrt(std::max(0.0, rest) / static_cast<double>(near.size() - surface_numbers));
}

}  // namespace

double automatic_threshold(const FitPoints& points)
{
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!is_finite(points.at(i))) return 0;
    const NearTree tree(points.x, points.y, points.z);
    SampleNumbers random(1);
    std::vector<double> found;
    std::vector<NearTree::Near> near;
    for (std::size_t i = 0; i < std::min(places, points.size()); ++i) {
        const std::size_t at = points.size() <= places ? i : random.below(points.size());
        tree.nearest(points.at(at), neighbours, near);
        const double noise = noise_near(points, near);
        if (noise >= 0) found.push_back(noise);
    }
    if (found.empty()) return 0;
    std::nth_element(found.begin(), found.begin() + found.size() / 3, found.end());
    return 3 * found[found.size() / 3];
}

}  // namespace pcm
