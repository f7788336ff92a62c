// How finely a cloud can be picked at a place.
#pragma once

#include "pcm/align/rigid_fit.h"
#include "pcm/point_cloud.h"

#include <vector>

namespace pcm {

struct PickSpacing {
    double distance = 0;  // distance from the place to the nearest point, source units
    double spacing = 0;   // distance from that point to the nearest one at another place; 0: there is none
};

// Throws what PointCloud::nearest() throws.
PickSpacing spacing_at(PointCloud& cloud, const Vec3d& place);

// FitOptions::pick_error of points picked where a cloud has these spacings: the place that is meant lies about a
// quarter of the spacing from the point that is picked. Spacings of 0 are left out; 0 if there are no others.
double pick_error_of(const std::vector<double>& spacings);

}  // namespace pcm
