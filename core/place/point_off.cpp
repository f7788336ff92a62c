#include "pcm/place/point_off.h"

#include "pcm/place/followed_verdict.h"
#include "pcm/place/near_points.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cstddef>

namespace pcm {

void doubt_point_off(const PointCloud& cloud, const Vec3d& place, const Selection& limit, FittedPrimitive& found)
{
    const PointOffTuning& tuned = place_tuning().point_off;
    ShapeFit& fit = found.primitive.fit;
    if (fit.verdict != FitVerdict::good) return;
    NearOptions nearest;
    nearest.places = true;
    nearest.count = tuned.nearest;
    nearest.limit = limit;
    const NearPoints near = points_near(cloud, place, nearest);
    if (near.ids.empty()) return;
    const double away = distance_to(fit.shape, near.points.source(0));
    const double noise = std::max(fit.noise, largest_magnitude(cloud.info().grid.scale));
    const double most = traits_of(fit.shape.kind).is_flat() ? fit.threshold : tuned.min_away * noise;
    if (!(away > most)) return;
    std::size_t off = 0;
    for (std::size_t i = 0; i < near.ids.size(); ++i)
        off += distance_to(fit.shape, near.points.source(i)) > fit.threshold;
    if (off >= tuned.min_off)
        doubt(fit, FitIssue::other_surface,
              "the point that was picked is " + brief(away) +
                  " off it, and some of the points next to it, too, so it may "
                  "belong to another surface: pick a point farther from where they meet");
}

}  // namespace pcm
