// The stations of a cloud and how far they are apart around a place. A click asks more than once; all is read once.
#pragma once

#include "pcm/place/point_stations.h"
#include "pcm/place/station_survey.h"
#include "pcm/tree/tree.h"

#include <optional>

namespace pcm {

// Keeps a reference. One object by one thread. Throws what reading throws.
class StationsAround {
public:
    StationsAround(const Tree& tree, const Vec3d& place) : tree_(tree), place_(place) {}

    const PointStations& points();  // reads a chunk of each part when it is first asked for
    const StationSurvey& survey();  // reads the chunks from the root to the place then
    // Whether points say from which station they are: where those around the place do not show it, by other places.
    bool are_named();
    // Standard deviation that points of one surface have at most, by that of smooth surfaces around
    // (place.following.max_smooth_noise), source units; infinity where the survey has none.
    double most_noise();
    double surface_noise();  // the same, with the spread of the stations
    // Spread of the stations by the surfaces around, source units; `unknown` where points do not name them.
    double spread(double unknown);
    // The same with `own` evidence, and where both are few differences, with those of other places.
    StationSpread spread_with(const StationEvidence& own);

private:
    const StationsElsewhere& elsewhere();  // reads the chunks of some places then

    const Tree& tree_;
    const Vec3d place_;
    std::optional<PointStations> points_;
    std::optional<StationSurvey> survey_;
    std::optional<StationsElsewhere> elsewhere_;
};

}  // namespace pcm
