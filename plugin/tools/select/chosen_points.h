// The sets of points that the tool Select Points makes, of those that a view shows. Any thread.
#pragma once

#include "pcm/cloud/polygon.h"
#include "pcm/point_cloud.h"
#include "pcm/query/point_set.h"
#include "pcm/select/grow_from.h"
#include "pcm/view/camera.h"

#include <vector>

namespace pcm::host {

// All throw Error(cancelled) when the progress function of the query returns false, and what reading throws.

PointSet points_of(PointCloud& cloud, const Query& query);

struct Ball {
    Vec3d centre{};
    double radius = 0;
};
// The points in at least one of the balls; in one pass.
PointSet points_in_balls(PointCloud& cloud, const Query& shown, const std::vector<Ball>& balls);

// The points in a polygon in normalised device coordinates of the camera that no other shown point hides
// (select/front_points.h).
PointSet points_in_front(PointCloud& cloud, const Query& shown, const Camera& camera,
                         const std::vector<Vec2d>& polygon);

// Those that steps no longer than `distance` reach from a point of the cloud (select/grow_from.h), through shown points
// that are like it.
PointSet points_around(PointCloud& cloud, const Query& shown, NodeId node, std::uint32_t point, double distance,
                       const SeedLimits& limits);

}  // namespace pcm::host
