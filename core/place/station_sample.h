// Some points of a set with the stations that they were measured from.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/place/point_stations.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <vector>

namespace pcm {

// Every n-th point of each node, `most` points or slightly more; station 0 where the source of the stations is unknown.
// Streams, once; the result depends neither on threads nor on their order. Throws Error(cancelled), and what reading
// throws.
std::vector<PointOfStation> station_sample(const PointSet& points, const PointStations& stations, std::size_t most,
                                           unsigned threads, const ProgressFunction& progress = {});

std::vector<Vec3d> places_of(const std::vector<PointOfStation>& points);

}  // namespace pcm
