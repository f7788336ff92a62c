#include "pcm/measure/snap.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>

namespace pcm {

double largest_step(const Grid& grid)
{
    return std::max({std::fabs(grid.scale[0]), std::fabs(grid.scale[1]), std::fabs(grid.scale[2])});
}

SnappedPoint snap(PointCloud& cloud, const Vec3d& place)
{
    const NearestResult nearest = cloud.nearest(place, 1);
    if (nearest.points.empty())
        throw Error(ErrorCode::invalid_argument, cloud.tree()->folder(), "the cloud has no points to measure at");
    SnappedPoint snapped;
    snapped.point.position = nearest.points[0].position;
    snapped.distance = length(place - snapped.point.position);
    snapped.point.grid_step = largest_step(cloud.info().grid);
    snapped.point.cloud = cloud.tree()->folder().string();
    const NearestResult around = cloud.nearest(snapped.point.position, 5);
    double sum = 0;
    for (const Neighbour& neighbour : around.points) sum += length(neighbour.position - snapped.point.position);
    if (around.points.size() > 1) snapped.point.spacing = sum / static_cast<double>(around.points.size() - 1);
    return snapped;
}

}  // namespace pcm
