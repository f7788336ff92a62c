// How points leave their shape together beyond what shifts of their stations explain.
#pragma once

#include "pcm/place/departure.h"
#include "pcm/place/point_stations.h"
#include "pcm/place/swept_part.h"
#include "pcm/query/point_set.h"
#include "pcm/shapes/fitted_shape.h"
#include "pcm/system/progress.h"

#include <optional>

namespace pcm {

// Standard deviations, above 0, source units.
struct StationNoise {
    double spread = 0;  // a station's shift along each axis
    double noise = 0;   // a point's distance
};

// departure_of() with stations, for a sample of the fit's points, of those of `part` where there is one. Streams, once.
// Throws Error(cancelled), and what reading throws.
Departure departure_within_stations(const PointSet& points, const ShapeFit& fit, const PointStations& stations,
                                    const StationNoise& errors, const std::optional<SweptPart>& part, unsigned threads,
                                    const ProgressFunction& progress);

}  // namespace pcm
