#include "pcm/place/depth_levels.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/near_tree.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/flat_hull.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace pcm {
namespace {

// Points along a plane's normal, divided where there is none for a while.
class HeightGroups {
public:
    HeightGroups(const FitPoints& points, const Shape& plane, double gap) : group_(points.size(), 0)
    {
        std::vector<double> heights;
        for (std::size_t i = 0; i < points.size(); ++i) heights.push_back(signed_distance(plane, points.source(i)));
        std::vector<std::size_t> order(points.size());
        std::iota(order.begin(), order.end(), std::size_t(0));
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return heights[a] < heights[b]; });
        for (const std::size_t i : order) {
            if (groups_.empty() || heights[i] - groups_.back().last > gap)
                groups_.push_back({heights[i], heights[i], {}});
            groups_.back().last = heights[i];
            groups_.back().points.push_back(i);
            group_[i] = groups_.size() - 1;
        }
    }

    struct Group {
        double first = 0, last = 0;
        std::vector<std::size_t> points;
        double middle() const { return 0.5 * (first + last); }
        double width() const { return last - first; }
    };
    const std::vector<Group>& groups() const { return groups_; }
    bool are_together(std::size_t a, std::size_t b) const { return group_[a] == group_[b]; }

private:
    std::vector<Group> groups_;
    std::vector<std::size_t> group_;  // keyed by point
};

// Whether most points of a group have their nearest ones in it.
bool is_patch(const HeightGroups& heights, const HeightGroups::Group& group, const NearTree& tree,
              const FitPoints& points)
{
    const LevelTuning& tuned = place_tuning().levels;
    std::vector<NearTree::Near> near;
    std::size_t inside = 0;
    for (const std::size_t i : group.points) {
        tree.nearest(points.at(i), tuned.neighbours + 1, near);
        std::size_t together = 0;
        for (const NearTree::Near& other : near) together += other.index != i && heights.are_together(i, other.index);
        inside += static_cast<double>(together) >= tuned.min_together * static_cast<double>(tuned.neighbours);
    }
    return 2 * inside >= group.points.size();
}

// Number of groups of values that are farther apart.
std::size_t count_apart(std::vector<double> values, double gap)
{
    std::sort(values.begin(), values.end());
    std::size_t count = values.empty() ? 0 : 1;
    for (std::size_t i = 1; i < values.size(); ++i) count += values[i] - values[i - 1] > gap;
    return count;
}

// Corners and middles of the sides.
std::vector<Vec3d> places_along(const std::vector<Vec3d>& outline)
{
    std::vector<Vec3d> places;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        places.push_back(outline[i]);
        places.push_back(0.5 * (outline[i] + outline[(i + 1) % outline.size()]));
    }
    const std::size_t most = place_tuning().levels.places;
    for (std::size_t i = 0; i < most && places.size() > most; ++i) places[i] = places[i * places.size() / most];
    places.resize(std::min(places.size(), most));
    return places;
}

}  // namespace

std::vector<double> level_heights(const NearPoints& near, const Shape& plane, double noise)
{
    const LevelTuning& tuned = place_tuning().levels;
    const FitPoints& points = near.points;
    const double gap = std::max(tuned.gap_noises * noise, tuned.gap_spacings * near.spacing);
    const HeightGroups heights(points, plane, gap);
    const NearTree tree(points.x, points.y, points.z);
    std::size_t on_levels = 0;
    bool has_own = false;
    std::vector<double> levels;
    for (const HeightGroups::Group& group : heights.groups()) {
        if (group.width() > 2 * gap || !is_patch(heights, group, tree, points)) continue;
        on_levels += group.points.size();
        levels.push_back(group.middle());
        has_own = has_own || std::fabs(group.middle()) <= gap;
    }
    const double least = tuned.min_share * static_cast<double>(points.size());
    if (!has_own || levels.size() < 2 || static_cast<double>(on_levels) < least) return {};
    return levels;
}

void doubt_level(const PointCloud& cloud, const Selection& limit, Primitive& primitive)
{
    const LevelTuning& tuned = place_tuning().levels;
    ShapeFit& fit = primitive.fit;
    if (!fit.has_shape() || !traits_of(fit.shape.kind).is_flat() || primitive.bounds.outline.empty()) return;
    std::size_t looked_at = 0, with_levels = 0;
    std::vector<double> levels, steps;
    for (const Vec3d& place : places_along(primitive.bounds.outline)) {
        NearOptions options;
        options.count = tuned.points;
        options.places = true;
        options.limit = limit;
        const NearPoints near = points_near(cloud, place, options);
        if (fit.noise > tuned.max_noise * near.spacing) return;  // none, and no more to read
        ++looked_at;
        const std::vector<double> here = level_heights(near, fit.shape, fit.noise);
        if (!here.empty()) ++with_levels;
        for (std::size_t i = 0; i < here.size(); ++i) {
            levels.push_back(here[i]);
            if (i > 0) steps.push_back(here[i] - here[i - 1]);
        }
    }
    if (steps.empty() || 2 * with_levels < looked_at) return;
    std::sort(steps.begin(), steps.end());
    const double step = steps[steps.size() / 2];
    if (count_apart(std::move(levels), step / 2) < tuned.min_levels) return;
    // Evenly within a level, and across it from one of its borders to the other.
    fit.errors.position = std::hypot(fit.errors.position, step / std::sqrt(12.0));
    fit.errors.angle = std::hypot(fit.errors.angle, step / std::sqrt(3.0) / width_of(primitive.bounds.outline));
    doubt(
        fit, FitIssue::other_surface,
        "its points are one of several parallel levels " + brief(step) +
            " apart and without noise, as a depth camera records any surface: the errors contain that; for the surface "
            "itself give a threshold that holds several of them");
}

}  // namespace pcm
