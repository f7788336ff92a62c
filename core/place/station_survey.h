// How far the stations of a scanner are apart, from the surfaces around a place.
#pragma once

#include "pcm/fit/station_spread.h"
#include "pcm/place/point_stations.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <vector>

namespace pcm {

// A patch of surface that several stations see, or any one where stations are not known.
struct StationPatch {
    std::vector<std::uint32_t> stations;
    Vec3d normal{};
    // Normal equations h * x = u of the stations' heights x, after the surface is eliminated; h row by row.
    std::vector<double> h, u;
    double noise = 0;                       // source units
    double mixed = 0, mixed_by_chance = 0;  // numbers of points whose nearest neighbour is of another station
};

// What one surface says of the stations, and its normal.
struct StationPart {
    StationEvidence evidence;
    Vec3d normal{};
};

// What is known of the stations and those of the parts that agree with each other and with it: a part that contradicts
// the others by more than a few medians of the deviations is left out; first one that contradicts what is known, or
// that stations are where they are. Deviations are compared between parts of similar normals (by the largest component,
// up to place.patches.max_unlike): a station may be shifted along one axis more than along others.
StationEvidence agreeing_evidence(const StationEvidence& known, const std::vector<StationPart>& parts);

struct StationSurvey {
    std::vector<StationPatch> patches;  // those of little noise
    // False where points of different numbers do not mix on the surfaces: points of stations do, those of tiles,
    // objects or classes do not, so the attribute names something else.
    bool names_stations = true;
    bool is_shown = false;  // whether the points there show that, and it is not merely what is assumed
    double reach = 0;       // StationReach of the coarsest points of all parts, source units

    // What patches show that agree with each other and with what is known of the stations from elsewhere, that
    // included: the two faces of a plate, each seen by another station, contradict others by as much as the plate is
    // thick.
    StationEvidence evidence(const StationEvidence& known = {}) const;
    std::vector<StationPart> parts() const;  // one for each patch
    double noise() const;                    // median of the patches', source units; 0: no patch
};

// The points of the node at the place and of the nodes above it, in the box of the lowest of these, then of the next
// one until there is enough, are divided into cubes of some tens of points. A cube with points of several stations on
// one smooth surface (a height of the second degree over a plane, of as little noise as most) is evidence; one that
// contradicts the others by more than four of their deviations is left out of evidence(). Reads the chunks from the
// root to the place, once. The result does not depend on the order of points. Throws what reading throws.
StationSurvey station_survey(const Tree& tree, const PointStations& stations, const Vec3d& place);

// Whether points of different numbers mix at more of the places that show it than they do not: at a single one stations
// may see parts of the surfaces only.
bool name_stations(const std::vector<StationSurvey>& places);

// The same, and how far stations are apart, by some places all over the cloud; nothing of a cloud of few nodes, which a
// survey looks at as a whole.
struct StationsElsewhere {
    bool names_stations = false;
    double spread = 0;          // root of the mean square of the places' spreads, source units
    std::uint32_t freedom = 0;  // number of differences that it is from, of all places together
};
StationsElsewhere stations_elsewhere(const Tree& tree, const PointStations& stations);

}  // namespace pcm
