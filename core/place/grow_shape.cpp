#include "pcm/place/grow_shape.h"

#include "pcm/place/cover_points.h"
#include "pcm/place/crossing_surfaces.h"
#include "pcm/place/inner_points.h"
#include "pcm/place/near_shape.h"
#include "pcm/place/next_to.h"
#include "pcm/place/refit.h"
#include "pcm/place/swept_part.h"
#include "pcm/place/tuning.h"
#include "pcm/place/turned_surface.h"
#include "pcm/select/grow.h"
#include "pcm/shapes/flat_hull.h"
#include "pcm/system/progress_part.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace pcm {
namespace {

constexpr double rounds_end = 0.7;           // share of the progress
constexpr std::size_t most_sliced = 20000;   // points used to find a swept part
constexpr std::size_t most_outlined = 4000;  // points that show the outline of a plane
constexpr int most_middle_rounds = 3;
constexpr int most_threshold_steps = 4;  // lowerings of a threshold
constexpr int most_part_rounds = 8;      // in which a swept part settles

class ShapeGrowth {
public:
    ShapeGrowth(const PointSet& seeds, const GrowShapeOptions& options)
        : seeds_(seeds), options_(options), whole_progress_(options.progress), threshold_(options.threshold)
    {
        options_.progress = part_of(whole_progress_, 0, rounds_end);
    }

    GrownShape run(const Shape& start)
    {
        const PointSet none(seeds_.shared_tree());
        GrownShape grown{{}, 0, 1, none, start, threshold_, {}, 1, none, 0, false, 0};
        grown.fit.shape = start;
        const unsigned rounds = std::max(1u, options_.most_rounds);
        while (grown.rounds < rounds && !grown.converged) {
            const double begin = grown.rounds == 0 ? 0 : 1 - std::pow(0.5, grown.rounds);
            const double end = 1 - std::pow(0.5, ++grown.rounds);
            const Shape before = grown.fit.shape;
            const Box3d box = fit_reached(before, begin, end, options_.most_rounds > 0, grown);
            if (!grown.fit.has_shape()) break;
            grown.converged =
                change_in_errors(before, grown.fit.shape, grown.fit.errors, box.centre()) < tuned_.settled_change;
            if (options_.raise_threshold && grown.rounds < rounds) {
                const double raised = std::min(place_tuning().evidence.spread_noises * grown.fit.noise,
                                               tuned_.max_raised * options_.threshold);
                grown.converged = grown.converged && raised <= 1.05 * threshold_;
                if (!grown.converged) threshold_ = std::max(threshold_, raised);
            }
        }
        if (options_.lower_threshold && options_.most_rounds > 0) lower_threshold(grown);
        // Shared errors of neighbours enlarge the errors, so the last step may have been long.
        const bool is_settled = grown.converged && !(grown.agreement > 1);
        if (!is_settled && grown.fit.has_shape() && options_.most_rounds > 0) settle(grown);
        grown.noise = grown.fit.noise;
        if (grown.fit.has_shape() && options_.most_rounds > 0) leave_edges(grown);
        if (options_.most_rounds == 0) grown.rounds = 0;
        return grown;
    }

private:
    void reach(const Shape& shape, double begin, double end, GrownShape& grown) const
    {
        const NearShape near(shape, threshold_, options_.normal_angle, seeds_.tree().info().schema);
        std::optional<TurnedSurface> turned;
        if (options_.turned_angle < pi / 2)
            turned.emplace(shape, threshold_, options_.turned_edge, options_.turned_angle, seeds_.tree().info());
        GrowOptions grow_options;
        grow_options.limit = options_.limit;
        grow_options.test = &near;
        if (turned) grow_options.surroundings = &*turned;
        grow_options.memory_bytes = options_.memory_bytes;
        grow_options.threads = options_.threads;
        grow_options.progress = part_of(options_.progress, begin, end);
        grown.points = grow(seeds_, options_.step, grow_options);
        grown.followed = shape;
        grown.threshold = threshold_;
        grown.farther = 0;
    }

    // A fit to the points reached from the shape, to which it moves, or is judged by; returns their box.
    Box3d fit_reached(const Shape& shape, double begin, double end, bool moves, GrownShape& grown) const
    {
        const Shape from = shape;  // may be that of `grown`
        reach(from, begin, (begin + end) / 2, grown);
        const RefittedShape fitted = refit(grown.points, from, (begin + end) / 2, end, moves);
        grown.fit = fitted.fit;
        grown.agreement = fitted.agreement;
        return fitted.box;
    }

    void lower_threshold(GrownShape& grown)
    {
        const double begin = 1 - std::pow(0.5, grown.rounds);
        for (int step = 0; step < most_threshold_steps; ++step) {
            const double lower = std::max(place_tuning().evidence.spread_noises * grown.fit.noise,
                                          largest_magnitude(seeds_.tree().info().grid.scale));
            if (!grown.fit.has_shape() || !(threshold_ > tuned_.max_wide * grown.fit.noise) || !(lower < threshold_))
                return;
            threshold_ = lower;
            fit_reached(grown.fit.shape, begin, begin, true, grown);
            grown.converged = true;
        }
    }

    // The points of the last shape rather than of the one before it.
    void settle(GrownShape& grown) const
    {
        fit_reached(grown.fit.shape, 1 - std::pow(0.5, grown.rounds), 1, false, grown);
    }

    // Where another surface meets the shape, some of its points are within the threshold, all on one side.
    void leave_edges(GrownShape& grown)
    {
        options_.progress = part_of(whole_progress_, rounds_end, 1);
        const Shape before = grown.fit.shape;
        find_around(before, 0, 0.3, grown);
        PointSet inner = inner_points(grown.points, grown.around, before, threshold_, options_.threads,
                                      part_of(options_.progress, 0.3, 0.5));
        if (!grown.points.empty())
            grown.inner_share = static_cast<double>(inner.size()) / static_cast<double>(grown.points.size());
        const bool is_enough = grown.inner_share >= tuned_.min_inner;
        if (const auto part = swept_part_of(grown.points, grown))
            return fit_swept_part(*part, is_enough ? inner : grown.points, grown);
        const std::optional<FlatHull> face = narrow_face(grown);
        if (!is_enough) return contain_edges(inner, face, grown);
        if (face && fit_middle(*face, true, grown)) return;
        if (inner.size() == grown.points.size()) return;
        const RefittedShape fitted = refit(inner, before, 0.55, 0.7, true);
        if (!fitted.fit.has_shape()) return;
        if (change_in_errors(before, fitted.fit.shape, fitted.fit.errors, fitted.box.centre()) > tuned_.settled_change)
            reach(fitted.fit.shape, 0.7, 1, grown);
        take(fitted, grown);
    }

    void find_around(const Shape& shape, double begin, double end, GrownShape& grown) const
    {
        const NearShape near(shape, around_thresholds * threshold_, options_.normal_angle, seeds_.tree().info().schema);
        const double way = std::max(options_.step, around_thresholds * threshold_);
        grown.around = points_next_to(grown.points, way, near, options_.limit, options_.threads,
                                      part_of(options_.progress, begin, end));
    }

    // What points of other surfaces at the edges have moved the shape by, beyond what chance moves the few inner ones.
    void contain_edges(PointSet inner, const std::optional<FlatHull>& face, GrownShape& grown) const
    {
        PointSet points = grown.points, around = grown.around;
        const bool is_middle = face && fit_middle(*face, false, grown);
        if (is_middle) {
            points = inside(*face, grown.points);
            around = inside(*face, around);
            inner = inside(*face, inner_of(grown));
        }
        if (const auto plane = without_crossing(points, around, grown.fit.shape, threshold_, options_.threads,
                                                part_of(options_.progress, 0.5, 0.52))) {
            correct(plane->shape, tuned_.crossing_error, plane->middle, grown.fit);
            reach(plane->shape, 0.52, 0.55, grown);
            grown.fit.inliers = grown.points.size();
        }
        if (inner.size() < tuned_.min_compared) return;
        const RefittedShape fitted = refit(inner, grown.fit.shape, 0.55, 0.7, true);
        // The few inner ones of a middle differ from it by chance, too.
        const auto is_apart = [&] {
            return fitted.fit.has_shape() &&
                   change_in_errors(grown.fit.shape, fitted.fit.shape, fitted.fit.errors, fitted.box.centre()) >
                       place_tuning().narrow_faces.min_difference;
        };
        if (!is_middle || is_apart()) pcm::contain_edges(fitted.fit, fitted.box.centre(), grown.fit);
    }

    // The outline of a plane, where much of it is border.
    std::optional<FlatHull> narrow_face(const GrownShape& grown) const
    {
        if (!traits_of(grown.fit.shape.kind).is_flat()) return {};
        const std::vector<Vec3d> some = random_points(grown.points, most_outlined, options_.threads);
        const FlatHull outline(some, grown.fit.shape);
        const auto of_border =
            std::count_if(some.begin(), some.end(), [&](const Vec3d& p) { return !is_inside(outline, p); });
        if (!(static_cast<double>(of_border) >
              place_tuning().narrow_faces.min_border * static_cast<double>(some.size())))
            return {};
        return outline;
    }

    bool is_inside(const FlatHull& outline, const Vec3d& p) const
    {
        return outline.gap_to(p) <= -place_tuning().narrow_faces.border * threshold_;
    }

    PointSet inside(const FlatHull& outline, const PointSet& points) const
    {
        return points_where(
            points, [&](const Vec3d& p) { return is_inside(outline, p); }, options_.threads);
    }

    PointSet inner_of(const GrownShape& grown) const
    {
        return inner_points(grown.points, grown.around, grown.fit.shape, threshold_, options_.threads);
    }

    // Fits a face to its points without those of its border, where the rest determines it. Repeated, as the face was
    // turned when its points were found. `inner`: whether points at edges within the outline are left out, too.
    bool fit_middle(const FlatHull& face, bool inner, GrownShape& grown) const
    {
        const ShapeFit whole = grown.fit;
        bool is_settled = false;
        for (int round = 0; round < most_middle_rounds && !is_settled; ++round) {
            const PointSet middle = inside(face, inner ? inner_of(grown) : grown.points);
            if (middle.size() < tuned_.min_compared) return round > 0;
            const Shape before = grown.fit.shape;
            const RefittedShape fitted = refit(middle, before, 0.5, 0.52, true);
            const ShapeFit& fit = fitted.fit;
            const double most = place_tuning().narrow_faces.max_growth * whole.errors.angle;
            if (!fit.has_shape() || !(fit.errors.angle * whole.noise <= most * fit.noise)) return round > 0;
            is_settled = change_in_errors(before, fit.shape, fit.errors, fitted.box.centre()) <= tuned_.settled_change;
            if (!is_settled) reach(fit.shape, 0.52, 1, grown);
            take(fitted, grown);
        }
        return true;
    }

    static void take(const RefittedShape& fitted, GrownShape& grown)
    {
        grown.fit = fitted.fit;
        grown.fit.inliers = grown.points.size();
        grown.agreement = fitted.agreement;
        const ShapeErrors apart = difference_of(grown.followed, grown.fit.shape, fitted.box.centre());
        grown.farther = apart.position + apart.radius + apart.second + apart.angle * fitted.box.diagonal() / 2;
    }

    // Straight pipes turn the shape, and with it the points that are within the threshold and the ends that these show:
    // both are found again with the shape of the part, until it has settled.
    void fit_swept_part(SweptPart part, PointSet inner, GrownShape& grown)
    {
        for (int round = 0; round < most_part_rounds; ++round) {
            const Shape before = grown.fit.shape;
            const double begin = 0.55 + 0.45 * round / most_part_rounds, step = 0.15 / most_part_rounds;
            inner = points_where(
                inner, [&](const Vec3d& p) { return part.has(p); }, options_.threads,
                part_of(options_.progress, begin, begin + step));
            const RefittedShape fitted = refit(inner, part.shape, begin + step, begin + 2 * step, true);
            if (!fitted.fit.has_shape()) return;
            grown.part = part;
            take(fitted, grown);
            if (!(change_in_errors(before, fitted.fit.shape, fitted.fit.errors, fitted.box.centre()) >
                  tuned_.settled_change))
                return;
            reach(fitted.fit.shape, begin + 2 * step, begin + 3 * step, grown);
            grown.fit.inliers = grown.points.size();
            if (round + 1 == most_part_rounds) return;
            find_around(fitted.fit.shape, begin + 3 * step, begin + 3 * step, grown);
            inner = grown.points;
            if (const auto again = swept_part_of(inner, grown, &part))
                part = *again;
            else
                part.shape = fitted.fit.shape;
        }
    }

    // Without what straight pipes add to an elbow.
    std::optional<SweptPart> swept_part_of(const PointSet& points, const GrownShape& grown,
                                           const SweptPart* before = nullptr) const
    {
        if (grown.fit.shape.kind != ShapeKind::torus) return {};
        const ProgressFunction progress = part_of(options_.progress, 0.5, 0.5);
        return swept_part(grown.fit.shape, threshold_, random_points(points, most_sliced, options_.threads, progress),
                          random_points(grown.around, most_sliced, options_.threads, progress), before);
    }

    RefittedShape refit(const PointSet& points, const Shape& shape, double begin, double end, bool moves) const
    {
        RefitOptions refit;
        refit.threshold = threshold_;
        if (!moves) refit.most_steps = 0;
        refit.threads = options_.threads;
        refit.progress = part_of(options_.progress, begin, end);
        return refit_shape(points, shape, refit);
    }

    const PointSet& seeds_;
    const GrowthTuning& tuned_ = place_tuning().growth;
    GrowShapeOptions options_;
    const ProgressFunction whole_progress_;
    double threshold_;
};

}  // namespace

GrownShape grow_shape(const Shape& shape, const PointSet& seeds, const GrowShapeOptions& options)
{
    return ShapeGrowth(seeds, options).run(shape);
}

}  // namespace pcm
