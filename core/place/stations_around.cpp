#include "pcm/place/stations_around.h"

#include "pcm/cloud/numbers.h"
#include "pcm/place/tuning.h"

#include <cmath>

namespace pcm {

const PointStations& StationsAround::points()
{
    if (!points_) points_.emplace(tree_);
    return *points_;
}

const StationSurvey& StationsAround::survey()
{
    if (!survey_) survey_ = station_survey(tree_, points(), place_);
    return *survey_;
}

bool StationsAround::are_named() { return points().source() != StationSource::none && survey().names_stations; }

double StationsAround::surface_noise()
{
    const double noise = survey().noise();
    if (!(noise > 0)) return infinity;
    const double spread = are_named() ? survey().evidence().spread().spread : 0;
    return std::hypot(place_tuning().following.max_smooth_noise * noise, spread);
}

}  // namespace pcm
