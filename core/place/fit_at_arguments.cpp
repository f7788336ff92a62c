#include "pcm/place/fit_at_arguments.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/place/near_points.h"
#include "pcm/place/tuning.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace pcm {

void require_arguments(const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places,
                       const FitAtOptions& options)
{
    const auto refuse = [](const std::string& what, const std::string& hint = {}) {
        throw Error(ErrorCode::invalid_argument, {}, what, hint);
    };
    if (places.empty()) refuse("no place was given to fit a shape at", "pick one or more points of the surface");
    for (const std::vector<Vec3d>* list : {&places, &not_places})
        for (const Vec3d& p : *list) require_place("the picked place", p);
    for (const Vec3d& p : not_places)
        if (std::find(places.begin(), places.end(), p) != places.end())
            refuse("the place " + exact(p) + " was given both as one on the surface and as one off it");
    if (!(options.fit.threshold >= 0) || !std::isfinite(options.fit.threshold))
        refuse("the threshold is " + exact(options.fit.threshold) + "; it is a positive number of source units");
    if (!(options.radius >= 0) || !std::isfinite(options.radius))
        refuse("the radius of the neighbourhood is " + exact(options.radius) +
               "; it is a positive number of source units");
    if (!(options.registration >= 0) || !std::isfinite(options.registration))
        refuse("the registration is within " + exact(options.registration) +
               "; it is a positive number of millimetres");
    if (!(options.step >= 0) || !std::isfinite(options.step))
        refuse("the step of growth is " + exact(options.step) + "; it is a positive number of source units");
}

Clip left_out(const PointCloud& cloud, const Vec3d& place, const std::vector<Vec3d>& places, const Selection& limit,
              const FitAtOptions& options)
{
    NearOptions near;
    near.places = true;
    near.radius = options.radius;
    if (!(near.radius > 0)) near.count = options.count > 0 ? options.count : place_tuning().neighbourhood.first_points;
    near.limit = limit;
    double radius = points_near(cloud, place, near).radius;
    for (const Vec3d& p : places) radius = std::min(radius, length(p - place) / 2);
    return {Region::sphere(place, radius), true};
}

double registration_of(const FitAtOptions& options, const Tree& tree)
{
    return options.registration / 1000 / metres_per_unit(tree.info().metadata);
}

}  // namespace pcm
