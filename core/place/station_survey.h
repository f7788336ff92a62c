// How far the stations of a scanner are apart, from the surfaces around a place.
#pragma once

#include "pcm/fit/station_spread.h"
#include "pcm/place/point_stations.h"
#include "pcm/tree/tree.h"

namespace pcm {

struct StationSurvey {
    StationEvidence evidence;
    // False where points of different numbers do not mix on the surfaces: points of stations do, those of tiles,
    // objects or classes do not, so the attribute names something else.
    bool names_stations = true;
};

// The points of the node at the place and of the nodes above it, in the box of the lowest of these, then of the next
// one until there is enough, are divided into cubes of some tens of points. A cube with points of several stations on
// one smooth surface (a height of the second degree over a plane, of as little noise as most) is evidence; one that
// contradicts the others by more than four of their deviations is not. Reads the chunks from the root to the place,
// once. The result does not depend on the order of points. Throws what reading throws.
StationSurvey station_survey(const Tree& tree, const PointStations& stations, const Vec3d& place);

}  // namespace pcm
