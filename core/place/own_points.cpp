#include "pcm/place/own_points.h"

#include "pcm/place/inner_points.h"

namespace pcm {

PointSet own_points(const FittedPrimitive& found, unsigned threads, const ProgressFunction& progress)
{
    if (!found.part) return found.points;
    return points_where(
        found.points, [&](const Vec3d& p) { return found.part->has(p); }, threads, progress);
}

}  // namespace pcm
