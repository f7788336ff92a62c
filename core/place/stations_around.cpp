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

const StationsElsewhere& StationsAround::elsewhere()
{
    if (!elsewhere_) elsewhere_ = stations_elsewhere(tree_, points());
    return *elsewhere_;
}

bool StationsAround::are_named()
{
    return points().source() != StationSource::none && (survey().names_stations || elsewhere().names_stations);
}

double StationsAround::most_noise()
{
    const double noise = survey().noise();
    return noise > 0 ? place_tuning().following.max_smooth_noise * noise : infinity;
}

double StationsAround::surface_noise() { return std::hypot(most_noise(), spread(0)); }

double StationsAround::spread(double unknown) { return are_named() ? spread_with({}).spread : unknown; }

StationSpread StationsAround::spread_with(const StationEvidence& own)
{
    StationSpread found = survey().evidence(own).spread();
    if (found.freedom >= place_tuning().patches.enough_freedom) return found;
    const double both = found.freedom + elsewhere().freedom;
    if (both > 0)
        found.spread =
            std::sqrt((found.freedom * square(found.spread) + elsewhere().freedom * square(elsewhere().spread)) / both);
    found.freedom += elsewhere().freedom;
    return found;
}

}  // namespace pcm
