#include "pcm/place/station_departure.h"

#include "pcm/place/station_scan.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr std::uint64_t most_points = 4000;

// Every n-th point of each node.
struct Sample {
    std::uint64_t seen = 0;
    std::vector<Vec3d> points;
    std::vector<std::uint32_t> stations;

    void add(const Sample& other)
    {
        points.insert(points.end(), other.points.begin(), other.points.end());
        stations.insert(stations.end(), other.stations.begin(), other.stations.end());
    }
};

}  // namespace

Departure departure_within_stations(const PointSet& points, const ShapeFit& fit, const PointStations& stations,
                                    const StationNoise& errors, unsigned threads, const ProgressFunction& progress)
{
    StationScan scan(points, stations, {threads, progress, 1});
    const std::uint64_t every = 1 + points.size() / most_points;
    Sample sample = scan.sums(Sample(), [&](Sample& part, const Vec3d& p, std::uint32_t station) {
        if (part.seen++ % every != 0) return;
        part.points.push_back(p);
        part.stations.push_back(station);
    });
    return departure_of(fit.shape, fit.threshold, sample.points,
                        {std::move(sample.stations), errors.spread, errors.noise});
}

}  // namespace pcm
