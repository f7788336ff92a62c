#include "pcm/detect/sample_units.h"

#include "pcm/knn/unit_plan.h"

#include <algorithm>
#include <cstddef>

namespace pcm {
namespace {

// The part of a box that lies in another, counted in grid positions.
double shared(const Box3i& box, const Box3i& other)
{
    if (box.empty()) return 0;
    double share = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        const double low = static_cast<double>(std::max(box.min[a], other.min[a]));
        const double high = static_cast<double>(std::min(box.max[a], other.max[a]));
        if (high < low) return 0;
        share *= (high - low + 1) / (static_cast<double>(box.max[a]) - static_cast<double>(box.min[a]) + 1);
    }
    return share;
}

}  // namespace

std::vector<Box3i> SampleUnits::with_points(std::uint64_t count) const
{
    const auto all = static_cast<std::uint64_t>(static_cast<double>(count) / share_);
    std::vector<Box3i> boxes;
    for (const Box3i& box : plan_units(points_.tree(), all))
        if (points_.touches(box)) boxes.push_back(box);
    return boxes;
}

std::uint16_t SampleUnits::level_of(double cell) const
{
    const TreeInfo& info = points_.tree().info();
    for (std::uint16_t level = 0; level < info.levels; ++level)
        if (info.spacings[level] > 0 && info.spacings[level] <= cell) return level;
    return static_cast<std::uint16_t>(std::max(1, int(info.levels)) - 1);
}

// The finest level whose points are no nearer than a cell, or the coarsest one; and how many points of a sample there
// are for each point up to it. 0: not known.
SampleUnits::LevelGrowth SampleUnits::level_growth(double cell) const
{
    const std::vector<double>& spacings = points_.tree().info().spacings;
    LevelGrowth found;
    while (found.level + 1u < spacings.size() && spacings[found.level + 1u] >= cell) ++found.level;
    if (!spacings.empty()) found.growth = spacings[found.level] * spacings[found.level] / (cell * cell);
    return found;
}

// About how many points a sample of the whole tree has.
double SampleUnits::sample_points(double cell) const
{
    const auto all = static_cast<double>(points_.tree().info().points);
    const auto [level, growth] = level_growth(cell);
    const double points = growth > 0 ? static_cast<double>(points_.tree().points_to_level(level)) * growth : all;
    return std::clamp(points, 1.0, all);
}

// About how many of them lie in a box.
double SampleUnits::sample_points(const Box3i& box, double cell) const
{
    const auto [level, growth] = level_growth(cell);
    double all = 0, coarse = 0;
    std::vector<NodeId> open{0};
    while (!open.empty()) {
        const Node& node = points_.tree().node(open.back());
        open.pop_back();
        const double share = shared(node.box, box);
        if (share <= 0) continue;
        all += share * node.points;
        for (std::size_t k = 0; k < node.level_points.size() && node.first_level + k <= level; ++k)
            coarse += share * node.level_points[k];
        for (const NodeId child : node.children)
            if (child != no_node) open.push_back(child);
    }
    return growth > 0 ? std::min(all, coarse * growth) : all;
}

std::vector<Box3i> SampleUnits::with_cell(double cell) const
{
    const double points = static_cast<double>(points_.tree().info().points);
    const double most = static_cast<double>(unit_points) / share_;
    std::vector<Box3i> open = with_points(
                           static_cast<std::uint64_t>(static_cast<double>(unit_points) * points / sample_points(cell))),
                       units;
    std::reverse(open.begin(), open.end());
    while (!open.empty()) {
        const Box3i box = open.back();
        open.pop_back();
        const std::vector<Box3i> halves = halves_of(box, points_.tree().info().grid.scale);
        if (halves.empty() || sample_points(box, cell) <= most)
            units.push_back(box);
        else
            open.insert(open.end(), halves.rbegin(), halves.rend());
    }
    return units;
}

}  // namespace pcm
