#include "pcm/fit/pipe_start.h"

#include "pcm/cloud/numbers.h"
#include "pcm/shapes/axis_frame.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pcm {

std::optional<AxisLine> line_of(const std::vector<Vec3d>& points, double elongation)
{
    AxisLine line;
    if (points.size() < 3) return std::nullopt;
    const double share = 1 / static_cast<double>(points.size());
    for (const Vec3d& p : points) line.middle = line.middle + share * p;
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    for (const Vec3d& p : points) {
        const Vec3d d = p - line.middle;
        const Eigen::Vector3d e(d[0], d[1], d[2]);
        m += e * e.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
    if (!(solver.eigenvalues()[2] > elongation * elongation * solver.eigenvalues()[1])) return std::nullopt;
    for (std::size_t a = 0; a < 3; ++a) line.axis[a] = solver.eigenvectors()(static_cast<Eigen::Index>(a), 2);
    return line;
}

// The circle is u^2 + v^2 = 2 a u + 2 b v + c.
std::optional<Shape> cylinder_along(const AxisLine& line, const std::vector<Vec3d>& points)
{
    const AxisFrame frame(line.axis);
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Vec3d& p : points) {
        const double u = dot(p - line.middle, frame.u), v = dot(p - line.middle, frame.v);
        const Eigen::Vector3d row(2 * u, 2 * v, 1);
        m += row * row.transpose();
        right += (u * u + v * v) * row;
    }
    const Eigen::Vector3d x = m.ldlt().solve(right);
    const double square = x[2] + x[0] * x[0] + x[1] * x[1];
    if (!(square > 0) || !std::isfinite(square)) return std::nullopt;
    return Shape{ShapeKind::cylinder, line.middle + x[0] * frame.u + x[1] * frame.v, line.axis, std::sqrt(square), 0};
}

double extent_along(const Vec3d& axis, const std::vector<Vec3d>& points)
{
    double from = infinity, to = -infinity;
    for (const Vec3d& p : points) {
        from = std::min(from, dot(p, axis));
        to = std::max(to, dot(p, axis));
    }
    return to - from;
}

}  // namespace pcm
