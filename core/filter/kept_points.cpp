#include "pcm/filter/kept_points.h"

#include <cmath>

namespace pcm {

// The cubes are a little wider than the spacing: so points that are near to each other are in adjacent cubes however
// the quotients are rounded.
KeptPoints::KeptPoints(double spacing, const Vec3d& origin)
    : square_(spacing * spacing), side_(spacing * (1 + 0x1p-8)), origin_(origin), heads_(64, none)
{
}

KeptPoints::Cube KeptPoints::cube_of(const Vec3d& p) const
{
    Cube cube;
    for (std::size_t a = 0; a < 3; ++a) cube[a] = static_cast<std::int64_t>(std::floor((p[a] - origin_[a]) / side_));
    return cube;
}

std::size_t KeptPoints::slot(const Cube& cube) const
{
    std::uint64_t hash = 0;
    for (const std::int64_t c : cube) {
        hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
    }
    return hash & (heads_.size() - 1);
}

void KeptPoints::grow()
{
    heads_.assign(2 * heads_.size(), none);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
        std::uint32_t& head = heads_[slot(cube_of(points_[i]))];
        next_[i] = head;
        head = i;
    }
}

void KeptPoints::add(const Vec3d& p)
{
    if (2 * points_.size() >= heads_.size()) grow();
    std::uint32_t& head = heads_[slot(cube_of(p))];
    next_.push_back(head);
    head = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
}

bool KeptPoints::has_near(const Vec3d& p) const
{
    const Cube at = cube_of(p);
    // The point's own cube first: most near points are there.
    static constexpr std::int64_t steps[] = {0, -1, 1};
    for (const std::int64_t z : steps)
        for (const std::int64_t y : steps)
            for (const std::int64_t x : steps)
                for (std::uint32_t i = heads_[slot({at[0] + x, at[1] + y, at[2] + z})]; i != none; i = next_[i]) {
                    const Vec3d& q = points_[i];
                    const double dx = q[0] - p[0], dy = q[1] - p[1], dz = q[2] - p[2];
                    if ((dx * dx + dy * dy) + dz * dz < square_) return true;
                }
    return false;
}

}  // namespace pcm
