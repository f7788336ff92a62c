#include "pcm/place/point_off.h"

#include "pcm/place/followed_verdict.h"
#include "pcm/place/near_points.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcm {
namespace {

// Distances from the shape of the point nearest to the place and of those next to it, to that point's side.
std::vector<double> distances_at(const PointCloud& cloud, const Vec3d& place, const Selection& limit,
                                 const Shape& shape)
{
    NearOptions nearest;
    nearest.places = true;
    nearest.count = place_tuning().point_off.nearest;
    nearest.limit = limit;
    const NearPoints near = points_near(cloud, place, nearest);
    std::vector<double> distances;
    for (std::size_t i = 0; i < near.ids.size(); ++i)
        distances.push_back(signed_distance(shape, near.points.source(i)));
    if (!distances.empty() && distances.front() < 0)
        for (double& d : distances) d = -d;
    return distances;
}

double noise_of(const PointCloud& cloud, const ShapeFit& fit)
{
    return std::max(fit.noise, largest_magnitude(cloud.info().grid.scale));
}

void doubt_off(double away, ShapeFit& fit)
{
    doubt(fit, FitIssue::other_surface,
          "the point that was picked is " + brief(away) +
              " off it, and some of the points next to it, too, so it may "
              "belong to another surface: pick a point farther from where they meet");
}

}  // namespace

void doubt_point_off(const PointCloud& cloud, const Vec3d& place, const Selection& limit, FittedPrimitive& found)
{
    const PointOffTuning& tuned = place_tuning().point_off;
    ShapeFit& fit = found.primitive.fit;
    if (fit.verdict != FitVerdict::good || traits_of(fit.shape.kind).is_flat()) return;
    const std::vector<double> distances = distances_at(cloud, place, limit, fit.shape);
    if (distances.empty() || !(distances.front() > tuned.min_away * noise_of(cloud, fit))) return;
    const auto off =
        std::count_if(distances.begin(), distances.end(), [&](double d) { return std::fabs(d) > fit.threshold; });
    if (static_cast<std::size_t>(off) >= tuned.min_off) doubt_off(distances.front(), fit);
}

void doubt_point_aside(const PointCloud& cloud, const Vec3d& place, const Selection& limit, FittedPrimitive& found)
{
    ShapeFit& fit = found.primitive.fit;
    if (fit.verdict != FitVerdict::good) return;
    const std::vector<double> distances = distances_at(cloud, place, limit, fit.shape);
    // Where neighbours share errors, one next to it is off with it.
    const double most =
        std::max(place_tuning().point_off.far_away * noise_of(cloud, fit), found.agreement > 1 ? fit.threshold : 0);
    const auto off = std::count_if(distances.begin(), distances.end(), [&](double d) { return d > most; });
    if (!distances.empty() && distances.front() > most &&
        static_cast<std::size_t>(off) >= place_tuning().point_off.min_aside)
        doubt_off(distances.front(), fit);
}

}  // namespace pcm
