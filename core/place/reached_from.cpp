#include "pcm/place/reached_from.h"

#include "pcm/place/near_shape.h"
#include "pcm/place/turned_surface.h"
#include "pcm/select/grow.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/progress_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>

namespace pcm {
namespace {

// Holds for the places of a list, as exactly as sums of doubles are: seeds were relative to another place.
class AtPlaces final : public PlaceTest {
public:
    explicit AtPlaces(std::vector<Vec3d> places) : places_(std::move(places))
    {
        std::sort(places_.begin(), places_.end());
        for (const Vec3d& p : places_) slack_ = std::max(slack_, 1e-15 * largest_magnitude(p));
    }
    BoxRelation relation(const Box3d& box) const override
    {
        return any(box.min, box.max) ? BoxRelation::crosses : BoxRelation::outside;
    }
    bool holds(const Vec3d& p) const override { return any(p, p); }

private:
    bool any(const Vec3d& low, const Vec3d& high) const
    {
        auto p = std::lower_bound(places_.begin(), places_.end(), low[0] - slack_,
                                  [](const Vec3d& place, double x) { return place[0] < x; });
        for (; p != places_.end() && (*p)[0] <= high[0] + slack_; ++p)
            if ((*p)[1] >= low[1] - slack_ && (*p)[1] <= high[1] + slack_ && (*p)[2] >= low[2] - slack_ &&
                (*p)[2] <= high[2] + slack_)
                return true;
        return false;
    }

    std::vector<Vec3d> places_;
    double slack_ = 0;
};

// Groups of places that steps connect, one place of each.
class Groups {
public:
    Groups(const std::vector<Vec3d>& places, double step) : places_(places), step_(step)
    {
        for (std::size_t i = 0; i < places.size(); ++i) cells_[cell_of(places[i])].push_back(i);
    }
    std::vector<Vec3d> first_of_each()
    {
        std::vector<Vec3d> firsts;
        for (const Vec3d& place : places_) {
            auto& cell = cells_[cell_of(place)];
            const auto found =
                std::find_if(cell.begin(), cell.end(), [&](std::size_t i) { return &places_[i] == &place; });
            if (found == cell.end()) continue;  // connected to one before
            cell.erase(found);
            firsts.push_back(place);
            flood(place);
        }
        return firsts;
    }

private:
    using Cell = std::array<double, 3>;
    Cell cell_of(const Vec3d& p) const
    {
        return {std::floor(p[0] / step_), std::floor(p[1] / step_), std::floor(p[2] / step_)};
    }
    void flood(const Vec3d& from)
    {
        std::vector<Vec3d> front{from};
        while (!front.empty()) {
            const Vec3d p = front.back();
            front.pop_back();
            const Cell middle = cell_of(p);
            for (int k = 0; k < 27; ++k) {
                const auto cell =
                    cells_.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
                if (cell == cells_.end()) continue;
                const auto rest = std::partition(cell->second.begin(), cell->second.end(), [&](std::size_t i) {
                    return squared_distance(places_[i], p) > step_ * step_;
                });
                for (auto i = rest; i != cell->second.end(); ++i) front.push_back(places_[*i]);
                cell->second.erase(rest, cell->second.end());
            }
        }
    }

    const std::vector<Vec3d>& places_;
    const double step_;
    std::map<Cell, std::vector<std::size_t>> cells_;  // places that are in no group yet
};

}  // namespace

void keep_few_seeds(ReachedFrom& from, bool are_reached)
{
    if (!(from.step > 0)) return;
    if (!are_reached && (from.normal_angle < pi / 2 || from.turned_angle < pi / 2)) return;
    std::vector<Vec3d> near;
    for (const Vec3d& seed : from.seeds)
        if (distance_to(from.shape, seed) <= from.threshold) near.push_back(seed);
    from.seeds = Groups(near, from.step).first_of_each();
}

PointSet reach_again(const std::shared_ptr<const Tree>& tree, const ReachedFrom& from, const ReachOptions& options)
{
    PointSet seeds(tree);
    const AtPlaces places(from.seeds);
    std::mutex mutex;
    ScanOptions scan;
    scan.test = &places;
    scan.select.threads = options.threads;
    scan.select.progress = part_of(options.progress, 0, 0.2);
    scan_points(*tree, from.limit, scan, [&](const ScannedPoints& found) {
        const std::lock_guard lock(mutex);
        seeds.set(found.node, found.numbers);
    });
    if (!(from.step > 0) || seeds.empty()) return seeds;
    const NearShape near(from.shape, from.threshold, from.normal_angle, tree->info().schema);
    std::optional<TurnedSurface> turned;
    if (from.turned_angle < pi / 2)
        turned.emplace(from.shape, from.threshold, from.turned_edge, from.turned_angle, tree->info());
    GrowOptions grow_options;
    grow_options.limit = from.limit;
    grow_options.test = &near;
    if (turned) grow_options.surroundings = &*turned;
    grow_options.memory_bytes = options.memory_bytes;
    grow_options.threads = options.threads;
    grow_options.progress = part_of(options.progress, 0.2, 1);
    return grow(seeds, from.step, grow_options);
}

}  // namespace pcm
