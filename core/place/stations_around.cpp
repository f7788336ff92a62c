#include "pcm/place/stations_around.h"

namespace pcm {

const PointStations& StationsAround::points()
{
    if (!points_) points_.emplace(tree_);
    return *points_;
}

const StationSurvey& StationsAround::survey()
{
    if (!survey_) {
        survey_.emplace();
        if (points().source() != StationSource::none) survey_ = station_survey(tree_, points(), place_);
    }
    return *survey_;
}

bool StationsAround::are_named() { return points().source() != StationSource::none && survey().names_stations; }

}  // namespace pcm
