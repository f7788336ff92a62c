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
    // One of both: all points within a radius (source units, inclusive), or the nearest `count`.
    double radius = 0;
    std::size_t count = 0;
    // `count` is a number of places: several points with the same coordinates to the bit count as one, and only the
    // first is given, so that a scan that is repeated twenty times is fitted as one. Up to 256 points a place are read.
    bool places = false;
    Selection limit;  // only points that it chooses: clip box, conditions
    // Maximum number of points given. When there are more, these are all points of the coarsest levels, which are
    // spread evenly, and a random part of the first level that does not fit, the same one in each call.
    std::size_t most = 1000000;
    ProgressFunction progress;
};

struct NearPoints {
    struct Id {
        NodeId node = no_node;
        std::uint32_t index = 0;  // in the node's chunk
    };
    FitPoints points;         // the nearest first; with the cloud's normals, where it has any
    std::vector<Id> ids;      // one per point of `points`
    std::uint64_t found = 0;  // points there, before `most`
    double radius = 0;        // radius of the sphere about the place that holds them
    // Median distance of the nearest (at most 256) points to the nearest of them at another place, source units; 0
    // where there are no two places.
    double spacing = 0;
};

// At full density, out of core: nodes are read from the tree on disk, past any cache, the nearest first, and of them
// the segments that can hold wanted points. Distances and order are those of query/nearest.h, of the source coordinates
// that readers get. One thread. Memory: a chunk, and about 90 bytes per point that is given. Throws
// Error(invalid_argument) for options out of range (no or both sizes, more than 10 million points), what Selector
// throws, Error(cancelled), and what reading throws. A place without points gives none.
NearPoints points_near(const PointCloud& cloud, const Vec3d& place, const NearOptions& options);

}  // namespace pcm
