#include "pcm/place/cover_points.h"

#include "pcm/fit/random_numbers.h"
#include "pcm/select/point_scan.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr int directions_across = 64;

std::vector<Vec3d> directions_of(const Shape& shape)
{
    const Vec3d& axis = shape.axis;
    const Vec3d u = normalised(cross(axis, std::fabs(axis[0]) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
    const Vec3d v = cross(axis, u);
    std::vector<Vec3d> directions{axis, -1 * axis};
    for (int k = 0; k < directions_across; ++k) {
        const double a = 2 * pi * k / directions_across;
        directions.push_back(std::cos(a) * u + std::sin(a) * v);
    }
    return directions;
}

// The finest level up to which the set has no more than `most` points; the coarsest one if that has more.
std::uint16_t level_with(const PointSet& set, std::size_t most)
{
    const Tree& tree = set.tree();
    std::vector<std::uint64_t> points(std::max<std::size_t>(tree.info().levels, 1), 0);
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        if (set.count(id) == 0) continue;
        const Node& node = tree.node(id);
        const std::vector<std::uint32_t> numbers = set.points(id);
        auto begin = numbers.begin();
        for (std::size_t k = 0; k < node.level_points.size(); ++k) {
            const auto end = std::lower_bound(begin, numbers.end(), node.points_to_level(node.first_level + k));
            points[node.first_level + k] += static_cast<std::uint64_t>(end - begin);
            begin = end;
        }
    }
    std::uint64_t sum = points[0];
    std::uint16_t level = 0;
    while (level + 1u < points.size() && sum + points[level + 1u] <= most) sum += points[++level];
    return level;
}

// Which points of a set are taken.
class Choice {
public:
    static Choice of_coarse_levels(const PointSet& set, std::size_t most)
    {
        Choice choice;
        choice.all_ = set.size() <= most;
        if (!choice.all_) choice.level_ = level_with(set, most);
        return choice;
    }
    static Choice at_random(const PointSet& set, std::size_t most)
    {
        Choice choice;
        choice.all_ = set.size() <= most;
        if (!choice.all_) choice.share_ = static_cast<double>(most) / static_cast<double>(set.size());
        return choice;
    }
    bool has(const Tree& tree, NodeId id, std::uint32_t number) const
    {
        if (all_) return true;
        if (!share_) return number < tree.node(id).points_to_level(level_);
        SampleNumbers numbers((std::uint64_t(id) << 32) + number);
        return std::ldexp(static_cast<double>(numbers.next() >> 11), -53) < *share_;
    }

private:
    bool all_ = false;
    std::uint16_t level_ = 0;
    std::optional<double> share_;
};

// The chosen points, and the points of each node that are farthest from `middle` in each of the directions.
std::vector<Vec3d> some_points(const PointSet& set, const Choice& choice, const std::vector<Vec3d>& directions,
                               const Vec3d& middle, unsigned threads, const ProgressFunction& progress)
{
    const Tree& tree = set.tree();
    const SourceRounding rounding(tree.info());
    std::map<NodeId, std::vector<Vec3d>> parts;
    std::mutex mutex;
    ScanOptions scan;
    scan.within = &set;
    scan.columns = ColumnSet::only_positions();
    scan.select.threads = threads;
    scan.select.progress = progress;
    scan.stage = "Finding what the points cover";
    scan_points(tree, {}, scan, [&](const ScannedPoints& found) {
        std::vector<Vec3d> positions = source_positions(found, tree.info().grid, rounding);
        std::vector<bool> kept(positions.size(), false);
        for (std::size_t k = 0; k < positions.size(); ++k) kept[k] = choice.has(tree, found.node, found.numbers[k]);
        for (const Vec3d& direction : directions) {
            const auto along = [&](const Vec3d& p) { return dot(direction, p - middle); };
            const auto farthest = std::max_element(positions.begin(), positions.end(),
                                                   [&](const Vec3d& a, const Vec3d& b) { return along(a) < along(b); });
            kept[static_cast<std::size_t>(farthest - positions.begin())] = true;
        }
        std::size_t count = 0;
        for (std::size_t k = 0; k < positions.size(); ++k)
            if (kept[k]) positions[count++] = positions[k];
        positions.resize(count);
        const std::lock_guard lock(mutex);
        parts.emplace(found.node, std::move(positions));
    });
    std::vector<Vec3d> points;
    for (const auto& [node, positions] : parts) points.insert(points.end(), positions.begin(), positions.end());
    return points;
}

}  // namespace

std::vector<Vec3d> cover_points(const PointSet& set, const Shape& shape, unsigned threads,
                                const ProgressFunction& progress, std::size_t most)
{
    return some_points(set, Choice::of_coarse_levels(set, most), directions_of(shape), shape.point, threads, progress);
}

std::vector<Vec3d> coarse_points(const PointSet& set, std::size_t most, unsigned threads,
                                 const ProgressFunction& progress)
{
    return some_points(set, Choice::of_coarse_levels(set, most), {}, {}, threads, progress);
}

std::vector<Vec3d> random_points(const PointSet& set, std::size_t most, unsigned threads,
                                 const ProgressFunction& progress)
{
    return some_points(set, Choice::at_random(set, most), {}, {}, threads, progress);
}

}  // namespace pcm
