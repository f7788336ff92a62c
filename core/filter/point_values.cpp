#include "pcm/filter/point_values.h"

#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/filter/lane_sum.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t lanes = sum_lanes;

// Sums of products about the centroid, the point itself included.
SymmetricMatrix scatter_of(const OnePointsNeighbours& n)
{
    const double points = static_cast<double>(n.count + 1);
    const auto mean_of = [&](const double* values) {
        return lane_sum(n.count, [values](std::size_t j) { return values[j]; }) / points;
    };
    const Vec3d m{mean_of(n.dx), mean_of(n.dy), mean_of(n.dz)};
    double xx[lanes] = {m[0] * m[0]}, xy[lanes] = {m[0] * m[1]}, xz[lanes] = {m[0] * m[2]};
    double yy[lanes] = {m[1] * m[1]}, yz[lanes] = {m[1] * m[2]}, zz[lanes] = {m[2] * m[2]};
    const auto add = [&](std::size_t j, std::size_t l) {
        const double x = n.dx[j] - m[0], y = n.dy[j] - m[1], z = n.dz[j] - m[2];
        xx[l] += x * x, xy[l] += x * y, xz[l] += x * z;
        yy[l] += y * y, yz[l] += y * z, zz[l] += z * z;
    };
    std::size_t j = 0;
    for (; j + lanes <= n.count; j += lanes)
        for (std::size_t l = 0; l < lanes; ++l) add(j + l, l);
    for (; j < n.count; ++j) add(j, 0);
    return {sum_of_lanes(xx), sum_of_lanes(xy), sum_of_lanes(xz), sum_of_lanes(yy), sum_of_lanes(yz), sum_of_lanes(zz)};
}

void find_shape(const OnePointsNeighbours& neighbours, PointValues& values)
{
    if (neighbours.count < 2) return;
    const SmallestEigenvector smallest = smallest_eigenvector(scatter_of(neighbours));
    const double l0 = std::max(0.0, smallest.values[0]), l1 = std::max(l0, smallest.values[1]);
    const double l2 = smallest.values[2];
    if (!(l2 > 0)) return;
    values.normal = smallest.vector;
    values.curvature = l0 / (l0 + l1 + l2);
    if (l1 < 0.01 * l2)
        values.confidence = NormalConfidence::line;
    else if (l0 > 0.4 * l1)
        values.confidence = NormalConfidence::blob;
    else
        values.confidence = NormalConfidence::good;
}

double radius_across(const OnePointsNeighbours& neighbours, const Vec3d& n)
{
    double most[lanes] = {};
    const auto see = [&](std::size_t j, std::size_t l) {
        const double x = neighbours.dx[j], y = neighbours.dy[j], z = neighbours.dz[j];
        const double along = n[0] * x + n[1] * y + n[2] * z;
        const double u = x - n[0] * along, v = y - n[1] * along, w = z - n[2] * along;
        const double square = u * u + v * v + w * w;
        most[l] = square > most[l] ? square : most[l];
    };
    std::size_t j = 0;
    for (; j + lanes <= neighbours.count; j += lanes)
        for (std::size_t l = 0; l < lanes; ++l) see(j + l, l);
    for (; j < neighbours.count; ++j) see(j, 0);
    return std::sqrt(std::max(std::max(most[0], most[1]), std::max(most[2], most[3])));
}

}  // namespace

double mean_distance_of(const double* squared, std::size_t count)
{
    if (count == 0) return 0;
    double sum = 0;
    for (std::size_t j = 0; j < count; ++j) sum += std::sqrt(squared[j]);
    return sum / static_cast<double>(count);
}

PointValues values_of(const OnePointsNeighbours& neighbours, const WantedValues& wanted, const Vec3d* known_normal)
{
    PointValues values;
    if (wanted.needs_shape()) find_shape(neighbours, values);
    if (wanted.radius && neighbours.count > 0) {
        OnePointsNeighbours covered = neighbours;
        if (wanted.radius_neighbours) covered.count = std::min(covered.count, wanted.radius_neighbours);
        const Vec3d* normal = wanted.normal ? &values.normal : known_normal;
        values.radius = normal && *normal != Vec3d{0, 0, 0} ? radius_across(covered, *normal)
                                                            : std::sqrt(covered.squared[covered.count - 1]);
    }
    if (wanted.mean_distance) values.mean_distance = mean_distance_of(neighbours.squared, neighbours.count);
    return values;
}

}  // namespace pcm
