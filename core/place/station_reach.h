// How far a station of a scanner sees, for how much it is turned.
//
// A registration by n points with errors of e along each axis leaves a station shifted by about e / sqrt(n) and turned
// by e / (sqrt(n) r), r their distance from the axis: so by the shift over the distance at which it was held. Targets
// and overlaps are known to nobody afterwards; they lie at the ends of what a station sees. Points that fill a box are
// 1 / sqrt(3) of its half diagonal from their middle (root mean square).
#pragma once

#include "pcm/place/point_stations.h"
#include "pcm/tree/tree.h"

namespace pcm {

// sqrt(3) times how far the coarsest points of the tree are from the middle of those of their station, root mean
// square, source units. All points are of one station where these are not known. Reads a chunk of each part, of the
// first place.stations.max_parts; throws what that throws.
double station_reach(const Tree& tree, const PointStations& stations);

}  // namespace pcm
