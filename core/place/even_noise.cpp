#include "pcm/place/even_noise.h"

#include "pcm/fit/second_degree.h"
#include "pcm/place/tuning.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

using Vector6 = Eigen::Matrix<double, surface_numbers, 1>;
using Matrix6 = Eigen::Matrix<double, surface_numbers, surface_numbers>;

// Sum of the squared residuals from the surface of second degree through the first n points.
double squares_of(const std::vector<Vec3d>& points, std::size_t n)
{
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    const auto at = [&](std::size_t i) {
        const Vec3d d = points[i] - points.front();
        return Eigen::Vector3d(d[0], d[1], d[2]);
    };
    for (std::size_t i = 0; i < n; ++i) middle += at(i) / static_cast<double>(n);
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    double size = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector3d d = at(i) - middle;
        products += d * d.transpose();
        size = std::max(size, d.norm());
    }
    if (!(size > 0)) return 0;
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(products).eigenvectors();
    std::vector<Vector6> rows;
    std::vector<double> heights;
    Matrix6 a = 1e-12 * Matrix6::Identity();
    Vector6 b = Vector6::Zero();
    for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector3d t = axes.transpose() * (at(i) - middle) / size;
        Vector6 row;
        row << 1, t[1], t[2], t[1] * t[1], t[1] * t[2], t[2] * t[2];
        a += row * row.transpose();
        b += row * t[0];
        rows.push_back(row);
        heights.push_back(t[0]);
    }
    const Vector6 x = a.ldlt().solve(b);
    double squares = 0;
    for (std::size_t i = 0; i < n; ++i) squares += std::pow(heights[i] - rows[i].dot(x), 2);
    return squares * size * size;
}

}  // namespace

bool is_more_noise(double variance, double more, double than, double fewer)
{
    if (!(variance > than)) return false;
    if (!(than > 0)) return true;
    const double root = std::cbrt(variance / than), a = 2 / (9 * more), b = 2 / (9 * fewer);
    return ((1 - b) * root - (1 - a)) / std::sqrt(b * root * root + a) > place_tuning().even_noise.level;
}

EvenNoise even_noise(const std::vector<Vec3d>& nearest)
{
    const EvenNoiseTuning& tuned = place_tuning().even_noise;
    if (nearest.size() < tuned.first_points) return {};
    std::size_t count = tuned.first_points;
    double squares = squares_of(nearest, count);
    while (count < nearest.size()) {
        const auto wider = static_cast<std::size_t>(tuned.widening * static_cast<double>(count));
        const std::size_t next = std::min(nearest.size(), wider);
        const double all = squares_of(nearest, next), further = static_cast<double>(next - count),
                     free = static_cast<double>(count) - surface_numbers;
        if (is_more_noise((all - squares) / further, further, squares / free, free)) break;
        count = next;
        squares = all;
    }
    return {count, std::sqrt(squares / (static_cast<double>(count) - surface_numbers))};
}

}  // namespace pcm
