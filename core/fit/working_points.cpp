#include "pcm/fit/working_points.h"

#include "pcm/fit/block_loops.h"
#include "pcm/fit/random_numbers.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numeric>

namespace pcm {
namespace {

double largest_of(const std::vector<double>& column, double shift)
{
    return block_loops().largest(column.data(), column.size(), shift);
}

PointSpread spread_of(const FitPoints& points)
{
    PointSpread spread;
    const auto n = static_cast<double>(points.size());
    const std::array<const double*, 3> columns{points.x.data(), points.y.data(), points.z.data()};
    const double largest = std::max({largest_of(points.x, 0), largest_of(points.y, 0), largest_of(points.z, 0)});
    if (!(largest > 0)) return spread;
    // Nothing overflows.
    const double part = 1 / largest / n;
    for (std::size_t k = 0; k < 3; ++k)
        spread.middle[k] = largest * block_loops().sum_scaled(columns[k], points.size(), part);
    spread.extent = std::max({largest_of(points.x, spread.middle[0]), largest_of(points.y, spread.middle[1]),
                              largest_of(points.z, spread.middle[2])});
    if (!(spread.extent > 0)) return spread;
    // The smallest numbers have no inverse.
    const double factor = std::min(1 / spread.extent, 0x1p1022),
                 rest = factor < 0x1p1022 ? 1 : 1 / (spread.extent * factor);
    Eigen::Matrix3d products;
    for (int j = 0; j < 3; ++j)
        for (int k = j; k < 3; ++k) {
            const auto a = static_cast<std::size_t>(j), b = static_cast<std::size_t>(k);
            products(j, k) = products(k, j) = block_loops().sum_products(columns[a], columns[b], points.size(),
                                                                         spread.middle[a], spread.middle[b], factor);
        }
    const Eigen::Vector3d values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(products * (rest * rest / n)).eigenvalues();
    for (int k = 0; k < 3; ++k) spread.across[k] = std::sqrt(std::max(0.0, values[k]));
    return spread;
}

bool all_finite(const std::vector<double>& column)
{
    // 0 times what is not finite is NaN.
    return block_loops().sum_scaled(column.data(), column.size(), 0) == 0;
}

}  // namespace

Shape unscaled(Shape shape, const Vec3d& middle, double unit)
{
    shape.point = middle + unit * shape.point;
    for (const ShapeSize& size : traits_of(shape.kind).sizes)
        if (size.unit == SizeUnit::length) shape.*size.value *= unit;
    return shape;
}

Shape scaled(Shape shape, const Vec3d& middle, double unit)
{
    shape.point = (shape.point - middle) / unit;
    for (const ShapeSize& size : traits_of(shape.kind).sizes)
        if (size.unit == SizeUnit::length) shape.*size.value /= unit;
    return shape;
}

FitIssue obvious_issue(const FitPoints& points, ShapeKind kind, std::size_t parameters, PointSpread& spread)
{
    if (!is_finite(points.origin)) return FitIssue::not_finite;
    if (!all_finite(points.x) || !all_finite(points.y) || !all_finite(points.z)) return FitIssue::not_finite;
    if (points.size() < parameters) return FitIssue::too_few_points;
    spread = spread_of(points);
    // What coordinates of the source, rounded, can distinguish.
    const double digits = 8e-16 * (largest_magnitude(points.origin) + spread.extent);
    const auto none = [&](double across) { return across * spread.extent <= digits || across <= 1e-7; };
    if (spread.extent <= digits) return FitIssue::coincident;
    if (none(spread.across[1])) return FitIssue::collinear;
    if (!traits_of(kind).is_flat() && none(spread.across[0])) return FitIssue::coplanar;
    return FitIssue::none;
}

WorkingPoints working_points(const FitPoints& points, const PointSpread& spread, std::uint64_t seed)
{
    WorkingPoints result;
    result.given = &points;
    result.unit = std::exp2(std::ceil(std::log2(spread.extent)));
    result.middle = points.origin + spread.middle;
    const Vec3d middle = result.middle - points.origin;  // what is left of it
    const std::size_t n = points.size();
    result.index.resize(n);
    std::iota(result.index.begin(), result.index.end(), 0u);
    SampleNumbers random(seed ^ 0x5f17);
    for (std::size_t i = n; i > 1; --i) std::swap(result.index[i - 1], result.index[random.below(i)]);
    // A power of two, whose inverse multiplies as exactly as it divides; the smallest have none.
    const double unit = result.unit, inverse = 1 / unit;
    const auto coordinates = [&](const std::vector<double>& from, double shift, std::vector<double>& to) {
        to.resize(n);
        if (std::isfinite(inverse))
            for (std::size_t i = 0; i < n; ++i) to[i] = (from[result.index[i]] - shift) * inverse;
        else
            for (std::size_t i = 0; i < n; ++i) to[i] = (from[result.index[i]] - shift) / unit;
    };
    coordinates(points.x, middle[0], result.x);
    coordinates(points.y, middle[1], result.y);
    coordinates(points.z, middle[2], result.z);
    return result;
}

}  // namespace pcm
