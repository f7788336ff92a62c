#include "pcm/place/station_sample.h"

#include "pcm/place/station_scan.h"

#include <cstdint>

namespace pcm {
namespace {

struct Sample {
    std::uint64_t seen = 0;
    std::vector<PointOfStation> points;

    void add(const Sample& other) { points.insert(points.end(), other.points.begin(), other.points.end()); }
};

}  // namespace

std::vector<PointOfStation> station_sample(const PointSet& points, const PointStations& stations, std::size_t most,
                                           unsigned threads, const ProgressFunction& progress)
{
    StationScan scan(points, stations, {threads, progress, 1});
    const std::uint64_t every = 1 + points.size() / most;
    return scan
        .sums(Sample(),
              [&](Sample& part, const Vec3d& p, std::uint32_t station) {
                  if (part.seen++ % every == 0) part.points.push_back({p, station});
              })
        .points;
}

std::vector<Vec3d> places_of(const std::vector<PointOfStation>& points)
{
    std::vector<Vec3d> places;
    for (const PointOfStation& p : points) places.push_back(p.place);
    return places;
}

}  // namespace pcm
