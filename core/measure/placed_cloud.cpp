#include "pcm/measure/placed_cloud.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// The largest singular value, as the root of the largest eigenvalue of the product of the transpose and the matrix:
// Smith's closed form for symmetric matrices of three rows.
double largest_stretch(const std::array<Vec3d, 3>& m)
{
    double size = 0;
    for (const Vec3d& row : m) size = std::max(size, largest_magnitude(row));
    std::array<Vec3d, 3> s{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (const Vec3d& row : m) s[i][j] += (row[i] / size) * (row[j] / size);
    const double mean = (s[0][0] + s[1][1] + s[2][2]) / 3;
    for (std::size_t i = 0; i < 3; ++i) s[i][i] -= mean;
    double squares = 0;
    for (const Vec3d& row : s) squares += dot(row, row);
    const double p = std::sqrt(squares / 6);
    if (!(p > 0)) return size * std::sqrt(mean);
    const double half = dot(s[0] / p, cross(s[1] / p, s[2] / p)) / 2;
    return size * std::sqrt(mean + 2 * p * std::cos(std::acos(std::clamp(half, -1.0, 1.0)) / 3));
}

}  // namespace

PlacedCloud::PlacedCloud(PointCloud& cloud, const std::optional<Affine>& map) : cloud_(cloud), map_(map)
{
    if (!map_) return;
    const auto& m = map_->linear;
    const double determinant = map_->determinant();
    double volume = 1;  // volume of a box with the rows' lengths
    for (const Vec3d& row : m) volume *= length(row);
    if (!std::isfinite(volume) || !std::isfinite(determinant) || !is_finite(map_->pivot) || !is_finite(map_->target))
        throw Error(ErrorCode::invalid_argument, {},
                    "the matrix that places the cloud has NaN or infinite numbers, or too large ones");
    if (!(std::fabs(determinant) > 1e-12 * volume))
        throw Error(ErrorCode::invalid_argument, {}, "the matrix that places the cloud flattens it",
                    "give the layer a matrix with a determinant other than 0");
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d column = cross(m[(i + 1) % 3], m[(i + 2) % 3]) / determinant;
        for (std::size_t j = 0; j < 3; ++j) inverse_[j][i] = column[j];
    }
    most_stretch_ = largest_stretch(m);
}

Vec3d PlacedCloud::back(const Vec3d& p) const
{
    const Vec3d d = p - map_->target;
    return map_->pivot + Vec3d{dot(inverse_[0], d), dot(inverse_[1], d), dot(inverse_[2], d)};
}

Box3d PlacedCloud::bounds() const
{
    const Box3d own = cloud_.info().points ? cloud_.info().bounds() : Box3d();
    if (!map_ || own.empty()) return own;
    Box3d box;
    for (int corner = 0; corner < 8; ++corner)
        box.extend((*map_)(Vec3d{corner & 1 ? own.max[0] : own.min[0], corner & 2 ? own.max[1] : own.min[1],
                                 corner & 4 ? own.max[2] : own.min[2]}));
    return box;
}

// normal . (p - centre) + offset >= 0 with p = linear (q - pivot) + target and q0 = back(centre) is
// (transpose(linear) normal) . (q - q0) + normal . (map(q0) - centre) + offset >= 0; q0 is rounded, and so is p.
Region PlacedCloud::own_region(const Region& region) const
{
    if (!map_) return region;
    const auto& m = map_->linear;
    const Vec3d centre = back(region.centre()), there = (*map_)(centre);
    const Box3d own = cloud_.info().points ? cloud_.info().bounds() : Box3d();
    double reach = std::max(largest_magnitude(map_->pivot), largest_magnitude(centre));
    if (!own.empty()) reach = std::max({reach, largest_magnitude(own.min), largest_magnitude(own.max)});
    const double margin = 1e-14 * (most_stretch_ * reach + largest_magnitude(map_->target));
    const std::vector<Region::Plane> given = region.half_spaces().value();
    std::vector<Region::Plane> planes;
    for (const Region::Plane& plane : given) {
        Region::Plane own_plane;
        for (std::size_t i = 0; i < 3; ++i) own_plane.normal = own_plane.normal + plane.normal[i] * m[i];
        own_plane.offset = plane.offset + dot(plane.normal, there - region.centre()) + length(plane.normal) * margin;
        planes.push_back(own_plane);
    }
    return Region::convex(centre, planes);
}

}  // namespace pcm
