#include "pcm/place/station_sides.h"

#include "pcm/cloud/numbers.h"
#include "pcm/place/tuning.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>

namespace pcm {
namespace {

constexpr double most_by_chance = 0.1;  // share of the variance, of ten stations and more

struct SeenPlane {
    std::uint32_t station = 0;
    double points = 0, mean = 0, squares = 0;  // squares of the distances from the mean
};

std::vector<SeenPlane> seen_by_stations(const Shape& plane, const std::vector<PointOfStation>& points)
{
    std::map<std::uint32_t, SeenPlane> stations;
    for (const PointOfStation& p : points) {
        SeenPlane& seen = stations[p.station];
        const double away = signed_distance(plane, p.place), change = away - seen.mean;
        seen.points += 1;
        seen.mean += change / seen.points;
        seen.squares += change * (away - seen.mean);
    }
    std::vector<SeenPlane> all;
    for (auto& [station, seen] : stations) {
        seen.station = station;
        if (seen.points >= place_tuning().sides.min_points) all.push_back(seen);
    }
    std::sort(all.begin(), all.end(), [](const SeenPlane& a, const SeenPlane& b) { return a.mean < b.mean; });
    return all;
}

struct Group {
    double stations = 0, mean = 0, squares = 0, points = 0;
};

Group group_of(const std::vector<SeenPlane>& all, std::size_t begin, std::size_t end)
{
    Group group;
    group.stations = static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
        group.mean += all[i].mean / group.stations;
        group.points += all[i].points;
    }
    for (std::size_t i = begin; i < end; ++i) group.squares += std::pow(all[i].mean - group.mean, 2);
    return group;
}

}  // namespace

bool StationSides::are_two(double noise, double spread) const
{
    const SideTuning& tuned = place_tuning().sides;
    const double of_points = noise > 0 ? std::min(noise, within) : within;
    if (!(apart > tuned.min_noises * of_points) || !(share > tuned.min_share)) return false;
    const bool is_far = apart > std::hypot(tuned.min_noises * of_points, tuned.min_spreads * spread);
    const double by_chance = 0.014 * (static_cast<double>(below.size() + above.size()) - 3.5);
    const std::size_t fewest = std::min(below.size(), above.size());
    return (is_far && gap > tuned.min_gap * apart) || (fewest > 1 && left < std::min(by_chance, most_by_chance));
}

StationSides station_sides(const Shape& plane, const std::vector<PointOfStation>& points)
{
    const std::vector<SeenPlane> all = seen_by_stations(plane, points);
    StationSides sides;
    double least = infinity, squares = 0, count = 0;
    std::size_t first_above = 0;
    for (const SeenPlane& seen : all) {
        squares += seen.squares;
        count += seen.points;
    }
    for (std::size_t i = 1; i < all.size(); ++i) {
        const Group below = group_of(all, 0, i), above = group_of(all, i, all.size());
        if (!(below.squares + above.squares < least)) continue;
        least = below.squares + above.squares;
        sides.apart = above.mean - below.mean;
        sides.gap = all[i].mean - all[i - 1].mean;
        sides.within = std::sqrt(squares / count);
        sides.share = std::min(below.points, above.points) / count;
        sides.middle = (above.mean + below.mean) / 2;
        first_above = i;
    }
    if (all.size() < 2) return sides;
    for (std::size_t i = 0; i < all.size(); ++i)
        (i < first_above ? sides.below : sides.above).push_back(all[i].station);
    const double whole = group_of(all, 0, all.size()).squares;
    if (whole > 0) sides.left = least / whole;
    return sides;
}

}  // namespace pcm
