#include "pcm/tree/verify_levels.h"

#include "pcm/cloud/numbers.h"
#include "pcm/threads/crew.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/level_cubes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pcm {
namespace {

// A box of the cloud at one level.
struct Tile {
    std::size_t level;
    Box3i box;
};

// The measurements of tiles of one level. Merging in another order changes nothing but the rounding of the two sums.
struct Sums {
    double least = infinity, farthest = 0;  // squared
    double sum = 0, sum_of_squares = 0;     // sums of (distance / spacing - 1) and its square
    std::uint64_t points = 0, isolated = 0;

    void merge(const Sums& o)
    {
        least = std::min(least, o.least);
        farthest = std::max(farthest, o.farthest);
        sum += o.sum;
        sum_of_squares += o.sum_of_squares;
        points += o.points;
        isolated += o.isolated;
    }
};

class Measurement {
public:
    Measurement(const Tree& tree, unsigned threads, const ProgressFunction& progress, std::size_t tile_points)
        : tree_(tree), info_(tree.info()), threads_(thread_count(threads)), tile_points_(tile_points), watch_(progress)
    {
    }

    LevelsReport run()
    {
        LevelsReport report;
        report.coverage_limit = coverage_limit();
        for (std::size_t level = 0; level < info_.spacings.size() && info_.spacings[level] > 0; ++level)
            if (info_.points) tiles_.push_back({level, info_.box});
        sums_.resize(tiles_.size());
        const double all =
            static_cast<double>(info_.points) * static_cast<double>(std::max<std::size_t>(1, tiles_.size()));
        Crew crew(signal_);
        for (unsigned t = 0; t < threads_; ++t) crew.add([this] { work(); });
        crew.join([&] {
            std::uint64_t done;
            {
                const std::lock_guard lock(signal_.mutex);
                done = points_done_;
            }
            watch_.report("Measuring levels", static_cast<double>(done) / all);
        });
        for (std::size_t level = 0; level < sums_.size(); ++level)
            report.levels.push_back(measure(level, report.coverage_limit, report.faults));
        report.seconds = watch_.seconds();
        return report;
    }

private:
    void work()
    {
        std::unique_lock lock(signal_.mutex);
        for (;;) {
            signal_.wake.wait(lock, [&] { return signal_.stopped || !tiles_.empty() || working_ == 0; });
            if (signal_.stopped || tiles_.empty()) return;
            const Tile tile = tiles_.back();
            tiles_.pop_back();
            ++working_;
            lock.unlock();
            std::vector<Tile> parts;
            const Sums sums = measure_tile(tile, parts);
            lock.lock();
            --working_;
            tiles_.insert(tiles_.end(), parts.begin(), parts.end());
            sums_[tile.level].merge(sums);
            signal_.wake.notify_all();
        }
    }

    // Calls use(position, level) for every point of the levels up to `level` in a box.
    template <class Use>
    void for_points(const Box3i& box, std::size_t level, const Use& use)
    {
        const NodeTable& nodes = tree_.nodes();
        std::vector<NodeId> open{0};
        while (!open.empty() && !signal_.stopped) {
            const NodeId id = open.back();
            open.pop_back();
            const Node& node = nodes[id];
            bool apart = false;
            for (std::size_t a = 0; a < 3; ++a)
                apart = apart || node.box.max[a] < box.min[a] || node.box.min[a] > box.max[a];
            if (apart || (node.points && node.first_level > level)) continue;
            for (const NodeId child : node.children)
                if (child != no_node) open.push_back(child);
            const std::uint32_t count = node.points_to_level(level);
            if (count == 0) continue;
            const Chunk chunk = tree_.read_chunk(id, ColumnSet::only_positions());
            std::size_t run = 0;
            std::uint32_t run_end = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                while (i >= run_end) run_end += node.level_points[run++];
                const Vec3i p = chunk.positions->grid(i);
                if (box.contains(p)) use(p, node.first_level + run - 1);
            }
        }
    }

    // The box grown by `distance` on all sides.
    Box3i around(const Box3i& box, double distance) const
    {
        Box3i wide = box;
        for (std::size_t a = 0; a < 3; ++a) {
            const double steps = std::min(std::ceil(distance / info_.grid.scale[a]) + 1, std::ldexp(1.0, 61));
            const auto by = static_cast<std::int64_t>(steps);
            wide.min[a] = wide.min[a] < std::numeric_limits<std::int64_t>::min() + by
                              ? std::numeric_limits<std::int64_t>::min()
                              : wide.min[a] - by;
            wide.max[a] = wide.max[a] > std::numeric_limits<std::int64_t>::max() - by
                              ? std::numeric_limits<std::int64_t>::max()
                              : wide.max[a] + by;
        }
        return wide;
    }

    // The points of the tile's level in it and within twice the spacing around it. More than tile_points_ are
    // thinned to every n-th, with n in `every`, unless `all`.
    std::vector<Vec3i> chosen_around(const Tile& tile, bool all, std::size_t& every)
    {
        std::vector<Vec3i> chosen;
        std::size_t number = 0;
        every = 1;
        for_points(around(tile.box, 2 * info_.spacings[tile.level]), tile.level, [&](const Vec3i& p, std::size_t) {
            if (number++ % every != 0) return;
            chosen.push_back(p);
            if (all || chosen.size() <= tile_points_) return;
            for (std::size_t i = 0; 2 * i < chosen.size(); ++i) chosen[i] = chosen[2 * i];
            chosen.resize((chosen.size() + 1) / 2);
            every *= 2;
        });
        return chosen;
    }

    // Measures a tile. A tile with too many chosen points is divided instead, and its halves are returned in `parts`.
    Sums measure_tile(const Tile& tile, std::vector<Tile>& parts)
    {
        std::size_t every = 1;
        std::vector<Vec3i> chosen = chosen_around(tile, false, every);
        if (every > 1) {
            if (divide(tile, chosen, parts)) return {};
            chosen = chosen_around(tile, true, every);
            if (divide(tile, chosen, parts)) return {};
        }
        const LevelCubes cubes(chosen, tile.box.min, info_.grid.scale, info_.spacings[tile.level]);
        Sums sums;
        measure_chosen(tile, cubes, chosen, sums);
        measure_others(tile, cubes, sums);
        return sums;
    }

    void measure_chosen(const Tile& tile, const LevelCubes& cubes, const std::vector<Vec3i>& chosen, Sums& sums) const
    {
        const double spacing = info_.spacings[tile.level];
        for (const Vec3i& p : chosen) {
            if (!tile.box.contains(p)) continue;
            ++sums.points;
            const double nearest = cubes.nearest(p, true);
            sums.least = std::min(sums.least, nearest);
            if (nearest <= 4 * spacing * spacing) {
                const double d = std::sqrt(nearest) / spacing - 1;
                sums.sum += d;
                sums.sum_of_squares += d * d;
            } else {
                ++sums.isolated;
            }
        }
    }

    // Most points have a chosen one nearer than the farthest so far, and need no more.
    void measure_others(const Tile& tile, const LevelCubes& cubes, Sums& sums)
    {
        const double most = 4 * info_.spacings[tile.level] * info_.spacings[tile.level];
        std::uint64_t tested = 0;
        LevelCubes::Recent recent;
        for_points(tile.box, info_.levels, [&](const Vec3i& p, std::size_t level) {
            ++tested;
            if (level <= tile.level || sums.farthest == infinity) return;
            if (cubes.has_within(p, sums.farthest, recent)) return;
            const double nearest = cubes.nearest(p, false);
            if (nearest <= sums.farthest) return;
            sums.farthest = nearest > most ? infinity : nearest;
        });
        const std::lock_guard lock(signal_.mutex);
        points_done_ += tested;
    }

    // Divides the tile at the median of these points inside, along the axis of their largest extent.
    bool divide(const Tile& tile, std::vector<Vec3i>& chosen, std::vector<Tile>& parts) const
    {
        // All of them stay: a tile that is not divided is measured with the points around it.
        const auto end =
            std::partition(chosen.begin(), chosen.end(), [&](const Vec3i& p) { return tile.box.contains(p); });
        if (end - chosen.begin() < 2) return false;
        Box3i tight;
        for (auto p = chosen.begin(); p != end; ++p) tight.extend(*p);
        std::size_t axis = 0;
        const auto extent = [&](std::size_t a) {
            return static_cast<double>(tight.max[a] - tight.min[a]) * info_.grid.scale[a];
        };
        for (std::size_t a = 1; a < 3; ++a)
            if (extent(a) > extent(axis)) axis = a;
        const auto middle = chosen.begin() + (end - chosen.begin()) / 2;
        std::nth_element(chosen.begin(), middle, end,
                         [&](const Vec3i& p, const Vec3i& q) { return p[axis] < q[axis]; });
        std::int64_t last = (*middle)[axis];  // last coordinate of the lower part
        if (last == tight.max[axis]) --last;
        if (last < tight.min[axis]) return false;
        Tile low = tile, high = tile;
        low.box.max[axis] = last;
        high.box.min[axis] = last + 1;
        parts = {low, high};
        return true;
    }

    double coverage_limit() const
    {
        if (!info_.coverage_kept) return infinity;
        if (info_.sampling == Sampling::grid) return 1;
        std::size_t parts = 0;
        for (const NodeId root : tree_.part_roots()) parts += root != no_node;
        return parts > 1 ? 2 : 1;
    }

    LevelMeasure measure(std::size_t level, double limit, std::vector<std::string>& faults) const
    {
        const Sums& sums = sums_[level];
        LevelMeasure measure;
        measure.spacing = info_.spacings[level];
        measure.points = sums.points;
        measure.least_distance = std::sqrt(sums.least) / measure.spacing;
        measure.coverage = std::sqrt(sums.farthest) / measure.spacing;
        measure.isolated = sums.isolated;
        if (const auto n = static_cast<double>(sums.points - sums.isolated); n > 0) {
            const double mean = sums.sum / n;
            measure.variation = std::sqrt(std::max(0.0, sums.sum_of_squares / n - mean * mean)) / (1 + mean);
        }
        const double squared = measure.spacing * measure.spacing;
        const std::string name = "level " + std::to_string(level) + ": ";
        if (info_.sampling == Sampling::poisson && sums.least < squared)
            faults.push_back(name + "two points are only " + std::to_string(measure.least_distance) +
                             " of its spacing apart");
        if (limit < infinity && sums.farthest >= limit * limit * squared)
            faults.push_back(name + "a point has none within " + (limit > 1 ? "twice " : "") +
                             "its spacing, the nearest is " + std::to_string(measure.coverage) + " of it away");
        return measure;
    }

    const Tree& tree_;
    const TreeInfo& info_;
    const unsigned threads_;
    const std::size_t tile_points_;
    Watch watch_;
    Signal signal_;
    std::vector<Tile> tiles_;
    std::size_t working_ = 0;
    std::vector<Sums> sums_;
    std::uint64_t points_done_ = 0;
};

}  // namespace

LevelsReport verify_levels(const Tree& tree, unsigned threads, const ProgressFunction& progress,
                           std::size_t tile_points)
{
    return Measurement(tree, threads, progress, tile_points).run();
}

}  // namespace pcm
