#include "pcm/place/station_departure.h"

#include "pcm/place/station_sample.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr std::size_t most_of_stations = 4000;

}  // namespace

Departure departure_within_stations(const PointSet& points, const ShapeFit& fit, const PointStations& stations,
                                    const StationNoise& errors, const std::optional<SweptPart>& part, unsigned threads,
                                    const ProgressFunction& progress)
{
    std::vector<Vec3d> places;
    std::vector<std::uint32_t> numbers;
    for (const PointOfStation& p : station_sample(points, stations, most_of_stations, threads, progress)) {
        if (part && !part->has(p.place)) continue;
        places.push_back(p.place);
        numbers.push_back(p.station);
    }
    // Points of one station are shifted together.
    const bool is_one = std::adjacent_find(numbers.begin(), numbers.end(), std::not_equal_to<>()) == numbers.end();
    if (is_one) return departure_of(fit.shape, fit.threshold, places);
    return departure_of(fit.shape, fit.threshold, places, {std::move(numbers), errors.spread, errors.noise});
}

}  // namespace pcm
