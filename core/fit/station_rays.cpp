#include "pcm/fit/station_rays.h"

#include "pcm/fit/tuning.h"

#include <cstddef>

namespace pcm {
namespace {

constexpr std::size_t least_points = 24;  // minimum number of a station's points that show the direction of its rays

bool set_direction(StationRays& rays)
{
    Vec3d sum{};
    for (const PointOnShape& p : rays.points) sum = sum + p.normal;
    const double size = length(sum);
    if (rays.points.size() < least_points ||
        !(size > fit_tuning().ray_errors.min_mean_normal * static_cast<double>(rays.points.size())))
        return false;
    rays.direction = (1 / size) * sum;
    return true;
}

}  // namespace

std::map<std::uint32_t, StationRays> rays_of(const Shape& shape, const std::vector<PointOfStation>& points,
                                             const Vec3d& middle, double extent)
{
    std::map<std::uint32_t, StationRays> stations;
    for (const PointOfStation& p : points)
        stations[p.station].points.push_back(
            {(1 / extent) * (p.place - middle), normal_at(shape, p.place), signed_distance(shape, p.place) / extent});
    for (auto station = stations.begin(); station != stations.end();)
        station = set_direction(station->second) ? std::next(station) : stations.erase(station);
    return stations;
}

}  // namespace pcm
