#include "pcm/build/bins/position_grid.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

Vec3d largest_of(const Box3d& box)
{
    Vec3d largest{0, 0, 0};
    for (std::size_t a = 0; a < 3 && !box.empty(); ++a)
        largest[a] = std::max(std::fabs(box.min[a]), std::fabs(box.max[a]));
    return largest;
}

}  // namespace

double power_of_two_step(double largest_magnitude)
{
    int exponent = 0;
    if (largest_magnitude > 0) std::frexp(largest_magnitude, &exponent);  // magnitude < 2^exponent
    return std::max(std::ldexp(1.0, exponent - 61), least_tree_step);
}

Grid power_of_two_grid(const Box3d& box)
{
    Grid grid;
    const Vec3d largest = largest_of(box);
    const double all = largest_magnitude(largest);
    for (std::size_t a = 0; a < 3; ++a) {
        // An axis of tiny coordinates need not be finer than 2^-40 of the largest.
        grid.scale[a] = power_of_two_step(std::max(largest[a], std::ldexp(all, -40)));
        grid.offset[a] = 0;
    }
    return grid;
}

bool resolves(const Grid& grid, const Box3d& box)
{
    const Vec3d largest = largest_of(box);
    for (std::size_t a = 0; a < 3; ++a)
        if (!((largest[a] + std::fabs(grid.offset[a])) / std::fabs(grid.scale[a]) <= std::ldexp(1.0, 50))) return false;
    return true;
}

void check_tree_grid(const Grid& grid)
{
    for (std::size_t a = 0; a < 3; ++a) {
        const double scale = std::fabs(grid.scale[a]), offset = std::fabs(grid.offset[a]);
        if (scale >= least_tree_step && scale <= std::ldexp(largest_tree_coordinate, -33) &&
            offset <= largest_tree_coordinate)
            continue;
        throw Error(ErrorCode::invalid_argument, {},
                    "the " + std::string(1, "xyz"[a]) + " coordinates are integers times " + exact(grid.scale[a]) +
                        " plus " + exact(grid.offset[a]) + "; a tree holds steps of at least " +
                        brief(least_tree_step) + " and coordinates up to " + brief(largest_tree_coordinate),
                    "scale the cloud before a tree is built of it");
    }
}

void check_tree_positions(const FarPoints& points)
{
    const Box3d& box = points.box();
    const double largest = largest_magnitude(largest_of(box));
    const double spacing = FarPoints::mean_spacing(box, points.points());
    if (spacing > 0 && power_of_two_step(largest) == least_tree_step && least_tree_step > spacing / 4)
        throw Error(ErrorCode::invalid_argument, {},
                    "the points are about " + brief(spacing) + " apart; a tree holds positions in steps of at least " +
                        brief(least_tree_step),
                    "scale the cloud before a tree is built of it");
    points.refuse([](const Box3d& part) { return power_of_two_grid(part).scale; }, "a tree's grid");
    if (largest > largest_tree_coordinate)
        throw Error(
            ErrorCode::invalid_argument, {},
            "there are coordinates of " + brief(largest) + "; a tree holds coordinates up to " +
                brief(largest_tree_coordinate),
            "scale the cloud before a tree is built of it; if they are no-data values, " + way_to_leave_out(1e100));
}

}  // namespace pcm
