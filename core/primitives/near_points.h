// The points around a picked place, of the whole cloud, as input of a fit.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/fit/fit_points.h"
#include "pcm/point_cloud.h"
#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

struct NearOptions {
    // One of both: all points within a radius (source units), or the nearest `count`.
    double radius = 0;
    std::size_t count = 0;
    Selection limit;             // only points that it chooses: clip box, conditions
    std::size_t most = 1000000;  // of these a part evenly spread, when there are more
    ProgressFunction progress;
};

struct NearPoints {
    struct Id {
        NodeId node = no_node;
        std::uint32_t index = 0;  // in the node's chunk
    };
    FitPoints points;         // with the cloud's normals, where it has any
    std::vector<Id> ids;      // of the same points
    std::uint64_t found = 0;  // points there, before `most`
    double radius = 0;        // of the sphere about the seed that holds them
    double spacing = 0;       // typical distance of a point to its nearest neighbour, source units
};

// At full density, out of core. Throws Error(invalid_argument) for options out of range (no or both sizes), what
// Selector throws, Error(cancelled), and what reading throws. A place without points gives none.
NearPoints points_near(const PointCloud& cloud, const Vec3d& place, const NearOptions& options);

}  // namespace pcm
