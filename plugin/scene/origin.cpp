#include "plugin/scene/origin.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

double largest_coordinate(const Box3d& box, const Vec3d& origin)
{
    double largest = 0;
    for (std::size_t a = 0; a < 3; ++a)
        largest = std::max({largest, std::fabs(box.min[a] - origin[a]), std::fabs(box.max[a] - origin[a])});
    return largest;
}

}  // namespace

Vec3d choose_origin(const Box3d& box)
{
    constexpr double lost_resolution = 8;  // accepted: 3 of float's 24 bits
    if (largest_coordinate(box, {0, 0, 0}) <= lost_resolution * box.diagonal()) return {0, 0, 0};
    const Vec3d centre = box.centre();
    // For a box of a few units, rounding to whole units could move the origin out of it.
    if (box.diagonal() < 4) return centre;
    return {std::round(centre[0]), std::round(centre[1]), std::round(centre[2])};
}

double float_rounding(const Box3d& box, const Vec3d& origin)
{
    const double largest = largest_coordinate(box, origin);
    if (largest == 0) return 0;
    return std::ldexp(1.0, std::ilogb(largest) - 24);  // half a unit in the last of 24 bits
}

}  // namespace pcm::host
