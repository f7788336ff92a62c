// A pipe at a place that is so thin, relative to the distance of points, that the nearest points are those of its
// neighbours, too: in a rack of pipes side by side.
//
// Points on one pipe are mostly nearer to each other than to the next pipe, and lie along a line. Short steps connect
// them, and show its direction, or the rack's where a few points bridge the gaps. Seen along it, a pipe is an arc or a
// circle.
#pragma once

#include "pcm/place/local_fit.h"

#include <optional>

namespace pcm {

// The pipe at the place, by least squares, of the points around it. Nearly all points up to some thresholds from it lie
// on it, at least over two fifths of its circle, and its noise is less than `most_noise`, source units. Nothing where
// there is no such pipe, where a threshold or a neighbourhood is given, and where cylinders are not among the kinds.
// Throws what points_near() throws.
std::optional<LocalFit> fit_thin_pipe(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options,
                                      double most_noise);

}  // namespace pcm
