#include "pcm/place/follow_local.h"

#include "pcm/fit/tuning.h"
#include "pcm/place/few_points.h"
#include "pcm/place/fit_at_arguments.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/grow_shape.h"
#include "pcm/place/tuning.h"
#include "pcm/place/turned_surface.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace pcm {
namespace {

constexpr double not_compared = 4;              // angle of surfaces, radians
const double even_spread = 1 / std::sqrt(3.0);  // rms distance of points anywhere within a threshold, per threshold

// One shape on its way through the cloud.
class FollowedOne {
public:
    FollowedOne(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options,
                const Selection& limit, StationsAround& around, NoiseNear noise, const KnownErrors& known,
                const ProgressFunction& progress, FollowedLocal& followed)
        : cloud_(cloud),
          places_(places),
          options_(options),
          limit_(limit),
          around_(around),
          noise_(noise),
          known_(known),
          progress_(progress),
          followed_(followed)
    {
    }

    void follow(const NearPoints& close)
    {
        FittedPrimitive& result = followed_.found;
        const ShapeFit& local = result.local;
        std::vector<Vec3d> positions;
        for (std::size_t i = 0; i < close.ids.size(); ++i)
            if (const Vec3d p = close.points.source(i); distance_to(local.shape, p) <= local.threshold)
                positions.push_back(p);
        result.step = options_.step > 0 ? options_.step : step_for(local.shape, automatic_step(positions));
        if (options_.step <= 0 && positions.size() < 2 && close.ids.size() >= 2)
            return come_back("none of the nearest points of the place lie on it", FitIssue::no_consensus, result);
        if (!(result.step > 0) || !(local.threshold > 0)) return;
        GrowShapeOptions options;
        options.threshold = local.threshold;
        options.raise_threshold = noise_ == NoiseNear::uneven;
        options.lower_threshold = options_.fit.threshold == 0;
        const double noise = options_.fit.threshold > 0 ? std::min(local.noise, local.threshold)
                                                        : local.threshold / fit_tuning().thresholds.inlier_noises;
        options.turned_edge = result.reached.turned_edge = TurnedSurface::edge_for(result.step, noise);
        if (!(options_.turned_angle > 0) &&
            !TurnedSurface::is_shown_on(local.shape, local.threshold, options.turned_edge))
            result.reached.turned_angle = not_compared;
        options.turned_angle = result.reached.turned_angle;
        options.step = result.step;
        options.normal_angle = options_.fit.normal_angle;
        options.most_rounds = options_.rounds;
        options.limit = limit_;
        options.memory_bytes = options_.memory_bytes;
        options.threads = options_.threads;
        options.progress = part_of(progress_, 0, noise_ == NoiseNear::even ? 0.6 : 0.9);
        FittedPrimitive raised = result;
        take(grow_shape(local.shape, result.points, options), noise_ == NoiseNear::narrow, result);
        if (!followed_.cuts_noise || noise_ != NoiseNear::even || result.primitive.fit.verdict == FitVerdict::good)
            return;
        // The surface's noise is larger elsewhere than at the place.
        options.raise_threshold = true;
        options.progress = part_of(progress_, 0.6, 0.9);
        take(grow_shape(local.shape, raised.points, options), false, raised);
        if (raised.left_surface.empty()) result = std::move(raised);
    }

private:
    // Where the place was picked, points may lie closer than elsewhere; and what stands before a pipe or a tank hides
    // less than half of its width.
    static double step_for(const Shape& shape, double step)
    {
        return std::max(step, std::min(4 * step, narrowest_radius(shape) / 2));
    }

    void take(GrownShape grown, bool is_narrow, FittedPrimitive& result)
    {
        followed_.cuts_noise = false;
        result.rounds = grown.rounds;
        result.converged = grown.converged;
        if (!grown.fit.has_shape())
            return come_back("the points reached determine no shape (" + std::string(name_of(grown.fit.issue)) + ")",
                             grown.fit.issue, result);
        if (options_.fit.threshold == 0 && grown.fit.noise > tuned_.max_noise_growth * result.local.noise)
            return come_back("its points leave it by " + brief(grown.fit.noise) + ", those around the place by " +
                                 brief(result.local.noise),
                             FitIssue::no_consensus, result);
        if (options_.fit.threshold == 0 && grown.fit.noise > even_spread * grown.threshold) {
            followed_.cuts_noise = true;
            return come_back("its points are spread evenly within the threshold, as points of no surface are",
                             FitIssue::no_consensus, result);
        }
        FittedPrimitive followed{result};
        take_grown(std::move(grown), followed);
        if (is_narrow) {
            if (followed_.other_kind) doubt(followed.primitive.fit, FitIssue::other_surface, followed_.other_doubt);
            doubt_few_points(followed);
        }
        const ShapeFit& fit = followed.primitive.fit;
        const bool is_doubted = fit.verdict != FitVerdict::good && result.local.verdict == FitVerdict::good;
        if (options_.fit.threshold == 0 && is_doubted && (is_narrow || fit.issue == FitIssue::no_consensus))
            return come_back(fit.message, fit.issue, result);
        result = std::move(followed);
    }

    void take_grown(GrownShape grown, FittedPrimitive& result)
    {
        result.agreement = grown.agreement;
        result.part = grown.part;
        result.points = std::move(grown.points);
        result.reached.shape = grown.followed;
        result.reached.threshold = grown.threshold;
        result.reached.step = result.step;
        keep_reached_seeds(result);
        grown.fit.iterations = result.local.iterations;
        if (result.local.issue == FitIssue::no_consensus || result.local.issue == FitIssue::other_surface) {
            grown.fit.verdict = result.local.verdict;
            grown.fit.issue = result.local.issue;
            grown.fit.message = result.local.message;
        }
        result.primitive.fit = std::move(grown.fit);
        FollowedVerdict verdict(cloud_, places_, options_, known_, around_, progress_);
        verdict.judge({grown.around, grown.noise, grown.agreement, grown.part, grown.inner_share}, result);
        result.primitive.fit.threshold += grown.farther;
        followed_.other_kind = verdict.other_kind();
        followed_.other_doubt = verdict.other_doubt();
        followed_.cuts_noise = verdict.cuts_noise();
        followed_.facts = FollowedFacts{grown.agreement, verdict.place_on_bend(), verdict.stations_at_place()};
    }

    static void keep_reached_seeds(FittedPrimitive& result)
    {
        std::vector<Vec3d> reached;
        for (std::size_t i = 0; i < result.near.ids.size(); ++i)
            if (result.local.is_inlier[i] && result.points.contains(result.near.ids[i].node, result.near.ids[i].index))
                reached.push_back(result.near.points.source(i));
        result.reached.seeds = std::move(reached);
        keep_few_seeds(result.reached, true);
    }

    const PointCloud& cloud_;
    const std::vector<Vec3d>& places_;
    const FitAtOptions& options_;
    const Selection& limit_;
    const FollowingTuning& tuned_ = place_tuning().following;
    StationsAround& around_;
    const NoiseNear noise_;
    const KnownErrors known_;
    const ProgressFunction& progress_;
    FollowedLocal& followed_;
};

}  // namespace

LocalFollower::LocalFollower(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options,
                             const Selection& limit, StationsAround& around)
    : cloud_(cloud), tree_(cloud.tree()), places_(places), options_(options), limit_(limit), around_(around)
{
}

FittedPrimitive LocalFollower::at_places(LocalFit local) const
{
    FittedPrimitive result{{}, PointSet(tree_), {}, {}, {}, 0, 0, false, 1, {}, {}, {}, {}};
    result.near = std::move(local.near);
    result.local = std::move(local.fit);
    result.notes = std::move(local.notes);
    Primitive& primitive = result.primitive;
    primitive.cloud = tree_->folder().string();
    primitive.estimator = traits_of(options_.fit.estimator).name;
    primitive.fit = result.local;
    primitive.fit.is_inlier.clear();
    if (!local.next_kind.empty()) result.notes.push_back(local.next_kind);
    if (!result.local.has_shape()) return result;
    std::map<NodeId, std::vector<std::uint32_t>> inliers;
    for (std::size_t i = 0; i < result.near.ids.size(); ++i)
        if (result.local.is_inlier[i]) {
            inliers[result.near.ids[i].node].push_back(result.near.ids[i].index);
            result.reached.seeds.push_back(result.near.points.source(i));
        }
    for (auto& [node, numbers] : inliers) {
        std::sort(numbers.begin(), numbers.end());
        result.points.set(node, numbers);
    }
    result.reached.shape = result.local.shape;
    result.reached.threshold = result.local.threshold;
    result.reached.normal_angle = options_.fit.normal_angle;
    result.reached.limit = limit_;
    return result;
}

FollowedLocal LocalFollower::follow(LocalFit local, NoiseNear noise, const ProgressFunction& progress) const
{
    const KnownErrors known{local.noise / fit_tuning().thresholds.inlier_noises, local.even.noise,
                            registration_of(options_, *tree_)};
    const NearPoints close = std::move(local.close);
    FollowedLocal followed{at_places(std::move(local)), {}, {}, false, {}};
    followed.found.reached.turned_angle = turned_angle(noise);
    if (options_.grow && !followed.found.points.empty())
        FollowedOne(cloud_, places_, options_, limit_, around_, noise, known, progress, followed).follow(close);
    return followed;
}

// Errors that neighbours share turn a surface: where the noise is uneven, it may be turned farther.
double LocalFollower::turned_angle(NoiseNear noise) const
{
    if (options_.turned_angle > 0) return options_.turned_angle;
    if (options_.fit.threshold > 0) return not_compared;
    return noise == NoiseNear::uneven ? pi / 4 : pi / 6;
}

}  // namespace pcm
