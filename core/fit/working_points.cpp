#include "pcm/fit/working_points.h"

#include "pcm/fit/random_numbers.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numeric>

namespace pcm {
namespace {

struct Spread {
    Vec3d middle{};
    double extent = 0;  // the largest coordinate relative to it
    Vec3d across{};     // root mean squares along the main directions, ascending, of coordinates of extent 1
};

Spread spread_of(const FitPoints& points)
{
    Spread spread;
    const auto n = static_cast<double>(points.size());
    double largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) largest = std::max(largest, largest_magnitude(points.at(i)));
    if (!(largest > 0)) return spread;
    for (std::size_t i = 0; i < points.size(); ++i) spread.middle = spread.middle + (1 / largest / n) * points.at(i);
    spread.middle = largest * spread.middle;
    for (std::size_t i = 0; i < points.size(); ++i)
        spread.extent = std::max(spread.extent, largest_magnitude(points.at(i) - spread.middle));
    if (!(spread.extent > 0)) return spread;
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d d = (points.at(i) - spread.middle) / spread.extent;
        const Eigen::Vector3d v(d[0], d[1], d[2]);
        products += v * v.transpose();
    }
    const Eigen::Vector3d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(products / n).eigenvalues();
    for (int k = 0; k < 3; ++k) spread.across[k] = std::sqrt(std::max(0.0, values[k]));
    return spread;
}

}  // namespace

Shape unscaled(Shape shape, const Vec3d& middle, double unit)
{
    shape.point = middle + unit * shape.point;
    shape.radius *= unit;
    if (shape.kind == ShapeKind::torus) shape.second *= unit;
    return shape;
}

Shape scaled(Shape shape, const Vec3d& middle, double unit)
{
    shape.point = (shape.point - middle) / unit;
    shape.radius /= unit;
    if (shape.kind == ShapeKind::torus) shape.second /= unit;
    return shape;
}

FitIssue obvious_issue(const FitPoints& points, ShapeKind kind, std::size_t parameters)
{
    if (!is_finite(points.origin)) return FitIssue::not_finite;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!is_finite(points.at(i))) return FitIssue::not_finite;
    if (points.size() < parameters) return FitIssue::too_few_points;
    const Spread spread = spread_of(points);
    // What coordinates of the source, rounded, can distinguish.
    const double digits = 8e-16 * (largest_magnitude(points.origin) + spread.extent);
    const auto none = [&](double across) { return across * spread.extent <= digits || across <= 1e-7; };
    if (spread.extent <= digits) return FitIssue::coincident;
    if (none(spread.across[1])) return FitIssue::collinear;
    if (kind != ShapeKind::plane && none(spread.across[0])) return FitIssue::coplanar;
    return FitIssue::none;
}

WorkingPoints working_points(const FitPoints& points, std::uint64_t seed)
{
    WorkingPoints result;
    const Spread spread = spread_of(points);
    result.unit = std::exp2(std::ceil(std::log2(spread.extent)));
    result.middle = points.origin + spread.middle;
    const Vec3d middle = result.middle - points.origin;  // what is left of it
    const std::size_t n = points.size();
    result.index.resize(n);
    std::iota(result.index.begin(), result.index.end(), 0u);
    SampleNumbers random(seed ^ 0x5f17);
    for (std::size_t i = n; i > 1; --i) std::swap(result.index[i - 1], result.index[random.below(i)]);
    const auto coordinates = [&](const std::vector<double>& from, double shift, double unit, std::vector<double>& to) {
        to.resize(n);
        for (std::size_t i = 0; i < n; ++i) to[i] = (from[result.index[i]] - shift) / unit;
    };
    coordinates(points.x, middle[0], result.unit, result.x);
    coordinates(points.y, middle[1], result.unit, result.y);
    coordinates(points.z, middle[2], result.unit, result.z);
    if (points.has_normals()) {
        coordinates(points.nx, 0, 1, result.nx);
        coordinates(points.ny, 0, 1, result.ny);
        coordinates(points.nz, 0, 1, result.nz);
    }
    return result;
}

}  // namespace pcm
