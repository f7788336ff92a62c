#include "pcm/place/few_points.h"

#include "pcm/place/cover_points.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/tuning.h"
#include "pcm/system/text.h"

namespace pcm {

void doubt_few_points(FittedPrimitive& result)
{
    ShapeFit& fit = result.primitive.fit;
    if (fit.verdict != FitVerdict::good || result.points.size() >= place_tuning().following.min_narrow_points) return;
    doubt(fit, FitIssue::no_consensus,
          "only " + grouped(result.points.size()) +
              " points lie on it before the noise rises, as some do by chance in a crown of a tree: pick more "
              "places, or give a threshold");
}

void doubt_small(FittedPrimitive& result, double metres_per_unit, unsigned threads)
{
    const FollowingTuning& tuned = place_tuning().following;
    ShapeFit& fit = result.primitive.fit;
    if (fit.verdict != FitVerdict::good || result.points.size() >= tuned.min_small_points) return;
    Box3d box;
    for (const Vec3d& p : random_points(result.points, tuned.min_small_points, threads, {})) box.extend(p);
    if (!(box.diagonal() * metres_per_unit < tuned.max_small)) return;
    doubt(fit, FitIssue::no_consensus,
          "only " + grouped(result.points.size()) + " points within " + brief(box.diagonal()) +
              " lie on it, as on a leaf: pick more places, or give a threshold");
}

}  // namespace pcm
