#include "pcm/select/grow.h"

#include "pcm/cloud/box_tree.h"
#include "pcm/knn/unit_plan.h"
#include "pcm/select/flood.h"
#include "pcm/select/point_scan.h"
#include "pcm/select/surroundings_test.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::uint64_t bytes_per_point = 192;  // memory of a unit

Box3d grown(Box3d box, double distance)
{
    for (std::size_t a = 0; a < 3; ++a) {
        const double slack = distance * 1e-9 + 4e-16 * std::max(std::fabs(box.min[a]), std::fabs(box.max[a]));
        box.min[a] -= distance + slack;
        box.max[a] += distance + slack;
    }
    return box;
}

Box3d intersection(const Box3d& a, const Box3d& b)
{
    Box3d both;
    for (std::size_t k = 0; k < 3; ++k) {
        both.min[k] = std::max(a.min[k], b.min[k]);
        both.max[k] = std::min(a.max[k], b.max[k]);
    }
    return both;
}

bool on_border(const Box3d& box, const Vec3d& p)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (p[a] == box.min[a] || p[a] == box.max[a]) return true;
    return false;
}

// A box of the cloud, whose points are flooded together.
struct Unit {
    Box3d box, reach;  // reach: grown by the distance
    bool queued = false, visited = false, complete = false;
    // Points that do not pass the test of what is around them, known after a visit: growth does not change them.
    std::optional<PointSet> failing;
};

class Growth {
public:
    Growth(const PointSet& seeds, double distance, const GrowOptions& options)
        : tree_(seeds.tree()),
          rounding_(tree_.info()),
          distance_(distance),
          options_(options),
          threads_(thread_count(options.threads)),
          watch_(options.progress),
          reached_(seeds)
    {
    }

    PointSet run()
    {
        watch_.report(stage, 0, true);
        plan();
        take_seeds();
        for (;;) {
            std::vector<std::size_t> wave;
            for (std::size_t u = 0; u < units_.size(); ++u)
                if (std::exchange(units_[u].queued, false) && !units_[u].complete) wave.push_back(u);
            if (wave.empty()) return std::move(reached_);
            for_each_index(
                wave.size(), threads_, [&](std::size_t i) { visit(units_[wave[i]]); }, [&](std::size_t) { report(); });
        }
    }

private:
    static constexpr const char* stage = "Growing the selection";

    struct Place {
        NodeId node;
        std::uint32_t number;
    };

    void report()
    {
        std::size_t complete = 0;
        {
            const std::lock_guard lock(mutex_);
            for (const Unit& unit : units_) complete += unit.complete;
        }
        watch_.report(stage, 0.99 * static_cast<double>(complete) / static_cast<double>(units_.size()));
    }

    void plan()
    {
        const std::uint64_t points = options_.memory_bytes / threads_ / bytes_per_point;
        for (const Box3i& box : plan_units(tree_, std::clamp<std::uint64_t>(points, 10000, 1000000))) {
            Unit unit;
            unit.box = source_box(tree_.info().grid, box, rounding_);
            unit.reach = grown(unit.box, distance_);
            units_.push_back(std::move(unit));
        }
        std::vector<Box3d> reaches;
        for (const Unit& unit : units_) reaches.push_back(unit.reach);
        reaches_ = BoxTree(std::move(reaches));
    }

    // A scan for positions by the thread of one unit: of points that pass the test, or of the set. Either may be null.
    static ScanOptions positions_of(const PlaceTest* test, const PointSet* within = nullptr)
    {
        ScanOptions scan;
        scan.test = test;
        scan.within = within;
        scan.columns = ColumnSet::only_positions();
        scan.select.threads = 1;
        return scan;
    }

    // The seeds that the limit chooses, and the units that they are near.
    void take_seeds()
    {
        PointSet seeds(reached_.shared_tree());
        ScanOptions scan = positions_of(options_.test, &reached_);
        scan.select.threads = options_.threads;
        scan_points(tree_, options_.limit, scan, [&](const ScannedPoints& found) {
            Box3d box;
            std::vector<Vec3d> positions;
            for (const std::uint32_t i : found.indices) {
                positions.push_back(position(found, i));
                box.extend(positions.back());
            }
            const std::vector<std::uint32_t> near = units_near(box, positions);
            const std::lock_guard lock(mutex_);
            seeds.set(found.node, found.numbers);
            for (const std::uint32_t u : near) units_[u].queued = true;
        });
        if (options_.surroundings) narrow_seeds(seeds);
        reached_ = std::move(seeds);
    }

    // To those that pass the test of what is around them. Unit by unit: seeds may be far apart.
    void narrow_seeds(PointSet& seeds) const
    {
        PointSet passing(seeds.shared_tree());
        for (const Unit& unit : units_) {
            if (!unit.queued) continue;
            std::map<NodeId, std::vector<std::pair<std::uint32_t, Vec3d>>> here;
            Box3d box;
            Selection inside;
            inside.box = unit.box;
            scan_points(tree_, inside, positions_of(nullptr, &seeds), [&](const ScannedPoints& found) {
                for (std::size_t i = 0; i < found.indices.size(); ++i) {
                    here[found.node].emplace_back(found.numbers[i], position(found, found.indices[i]));
                    box.extend(here[found.node].back().second);
                }
            });
            if (here.empty()) continue;
            const auto judge = judge_of(box);
            for (const auto& [node, places] : here) {
                std::vector<std::uint32_t> numbers;
                for (const auto& [number, p] : places)
                    if (judge->passes(p)) numbers.push_back(number);
                passing.combine(SetOperation::add, node, numbers);
            }
        }
        seeds = std::move(passing);
    }

    // The judge of places in the box.
    std::unique_ptr<SurroundingsTest::Judge> judge_of(const Box3d& box) const
    {
        auto judge = options_.surroundings->judge();
        Selection around = options_.limit;
        const Box3d wide = grown(box, options_.surroundings->margin());
        around.box = around.box ? intersection(*around.box, wide) : wide;
        scan_points(tree_, around, positions_of(&options_.surroundings->counts()), [&](const ScannedPoints& found) {
            for (const std::uint32_t i : found.indices) judge->add(position(found, i));
        });
        return judge;
    }

    Vec3d position(const ScannedPoints& found, std::uint32_t index) const
    {
        return rounding_(tree_.info().grid.to_source(found.part.chunk.positions->grid(index)));
    }

    // Those that have some of the positions, all of which lie in the box, within reach. Boxes of units do not change.
    std::vector<std::uint32_t> units_near(const Box3d& box, const std::vector<Vec3d>& positions) const
    {
        std::vector<std::uint32_t> near = positions.empty() ? std::vector<std::uint32_t>() : reaches_.touching(box);
        const auto is_far = [&](std::uint32_t u) {
            const auto reaches = [&](const Vec3d& p) { return units_[u].reach.contains(p); };
            return std::none_of(positions.begin(), positions.end(), reaches);
        };
        near.erase(std::remove_if(near.begin(), near.end(), is_far), near.end());
        return near;
    }

    void visit(Unit& unit)
    {
        PointSet reached(reached_.shared_tree());
        {
            const std::lock_guard lock(mutex_);
            reached = reached_;
        }
        std::vector<Place> places;
        std::vector<Vec3d> points;
        std::vector<bool> known;
        std::size_t open = 0;
        Selection here = options_.limit;
        here.box = here.box ? intersection(*here.box, unit.box) : unit.box;
        scan_points(tree_, here, positions_of(options_.test), [&](const ScannedPoints& found) {
            for (std::size_t i = 0; i < found.indices.size(); ++i) {
                const Vec3d p = position(found, found.indices[i]);
                const bool is_known = reached.contains(found.node, found.numbers[i]);
                if (!is_known && unit.failing && unit.failing->contains(found.node, found.numbers[i])) continue;
                open += !is_known;
                // What an earlier visit has reached has spread in this unit already. A point on the unit's border may
                // also be one of a neighbour, which has reached it.
                if (is_known && unit.visited && !on_border(unit.box, p)) continue;
                points.push_back(p);
                places.push_back({found.node, found.numbers[i]});
                known.push_back(is_known);
            }
        });
        if (options_.surroundings && open > 0 && !unit.failing) open -= leave_out(unit, points, places, known);
        std::size_t found = 0;
        if (open > 0) {
            Flood flood(std::move(points), unit.box, distance_);
            for (std::size_t i = 0; i < places.size(); ++i)
                if (known[i]) flood.reach(i);
            reach_from_outside(unit, reached, flood);
            flood.run();
            found = commit(unit, places, known, flood);
        }
        const std::lock_guard lock(mutex_);
        unit.visited = true;
        unit.complete = found == open;
    }

    // What is not known to be reached and does not pass the test of what is around it; returns how many these were.
    std::size_t leave_out(Unit& unit, std::vector<Vec3d>& points, std::vector<Place>& places,
                          std::vector<bool>& known) const
    {
        const auto judge = judge_of(unit.box);
        std::map<NodeId, std::vector<std::uint32_t>> failing;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!known[i] && !judge->passes(points[i])) {
                failing[places[i].node].push_back(places[i].number);
                continue;
            }
            points[kept] = points[i];
            places[kept] = places[i];
            known[kept++] = known[i];
        }
        const std::size_t left_out = points.size() - kept;
        points.resize(kept);
        places.resize(kept);
        known.resize(kept);
        unit.failing.emplace(reached_.shared_tree());
        for (const auto& [node, numbers] : failing) unit.failing->combine(SetOperation::add, node, numbers);
        return left_out;
    }

    void reach_from_outside(const Unit& unit, const PointSet& reached, Flood& flood) const
    {
        Selection around;
        around.box = unit.reach;
        scan_points(tree_, around, positions_of(nullptr, &reached), [&](const ScannedPoints& found) {
            for (const std::uint32_t i : found.indices) {
                const Vec3d p = position(found, i);
                if (!unit.box.contains(p)) flood.reach_from(p);
            }
        });
    }

    // Returns the number of points that were not known to be reached before.
    std::size_t commit(const Unit& unit, const std::vector<Place>& places, const std::vector<bool>& known,
                       const Flood& flood)
    {
        std::map<NodeId, std::vector<std::uint32_t>> by_node;
        std::vector<Vec3d> positions;
        for (std::size_t i = 0; i < places.size(); ++i)
            if (!known[i] && flood.reached(i)) {
                by_node[places[i].node].push_back(places[i].number);
                positions.push_back(flood.point(i));
            }
        const std::vector<std::uint32_t> near = units_near(unit.box, positions);
        const std::lock_guard lock(mutex_);
        for (const auto& [node, numbers] : by_node) reached_.combine(SetOperation::add, node, numbers);
        for (const std::uint32_t u : near)
            if (&units_[u] != &unit) units_[u].queued = true;
        return positions.size();
    }

    const Tree& tree_;
    const SourceRounding rounding_;
    const double distance_;
    const GrowOptions& options_;
    const unsigned threads_;
    Watch watch_;
    std::mutex mutex_;  // guards reached_ and the flags of units_
    PointSet reached_;
    std::vector<Unit> units_;
    BoxTree reaches_;  // boxes of units_
};

}  // namespace

PointSet grow(const PointSet& seeds, double distance, const GrowOptions& options)
{
    if (!(distance > 0) || !std::isfinite(distance))
        throw Error(ErrorCode::invalid_argument, seeds.tree().folder(),
                    "the distance of a step is " + exact(distance) + "; it is a positive number of source units");
    return Growth(seeds, distance, options).run();
}

}  // namespace pcm
