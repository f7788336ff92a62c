#include "pcm/primitives/grow_shape.h"

#include "pcm/primitives/near_shape.h"
#include "pcm/primitives/progress_part.h"
#include "pcm/primitives/refit.h"
#include "pcm/select/grow.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr double noises = 3.3, most_raised = 2.5;  // of a raised threshold

class ShapeGrowth {
public:
    ShapeGrowth(const PointSet& seeds, const GrowShapeOptions& options)
        : seeds_(seeds), options_(options), threshold_(options.threshold)
    {
    }

    GrownShape run(const Shape& start)
    {
        GrownShape grown{{}, 1, PointSet(seeds_.shared_tree()), start, threshold_, 0, false};
        grown.fit.shape = start;
        const unsigned rounds = std::max(1u, options_.most_rounds);
        while (grown.rounds < rounds && !grown.converged) {
            const double begin = grown.rounds == 0 ? 0 : 1 - std::pow(0.5, grown.rounds);
            const double end = 1 - std::pow(0.5, ++grown.rounds);
            const Shape before = grown.fit.shape;
            reach(before, begin, (begin + end) / 2, grown);
            const RefittedShape fitted = refit(grown.points, before, (begin + end) / 2, end, options_.most_rounds > 0);
            grown.fit = fitted.fit;
            grown.agreement = fitted.agreement;
            if (!grown.fit.has_shape()) break;
            grown.converged = change_in_errors(before, grown.fit.shape, grown.fit.errors, fitted.box.centre()) < 0.25;
            if (options_.raise_threshold && grown.rounds < rounds) {
                const double raised = std::min(noises * grown.fit.noise, most_raised * options_.threshold);
                grown.converged = grown.converged && raised <= 1.05 * threshold_;
                if (!grown.converged) threshold_ = std::max(threshold_, raised);
            }
        }
        // Errors that neighbours make large allow the last step to be long.
        const bool is_settled = grown.converged && !(grown.agreement > 1);
        if (!is_settled && grown.fit.has_shape() && options_.most_rounds > 0) settle(grown);
        if (options_.most_rounds == 0) grown.rounds = 0;
        return grown;
    }

private:
    void reach(const Shape& shape, double begin, double end, GrownShape& grown) const
    {
        const NearShape near(shape, threshold_, options_.normal_angle, seeds_.tree().info().schema);
        GrowOptions grow_options;
        grow_options.limit = options_.limit;
        grow_options.test = &near;
        grow_options.memory_bytes = options_.memory_bytes;
        grow_options.threads = options_.threads;
        grow_options.progress = part_of(options_.progress, begin, end);
        grown.followed = shape;
        grown.threshold = threshold_;
        grown.points = grow(seeds_, options_.step, grow_options);
    }

    // The points of the last shape rather than of the one before it.
    void settle(GrownShape& grown) const
    {
        const double begin = 1 - std::pow(0.5, grown.rounds);
        reach(grown.fit.shape, begin, (1 + begin) / 2, grown);
        const RefittedShape judged = refit(grown.points, grown.fit.shape, (1 + begin) / 2, 1, false);
        grown.fit = judged.fit;
        grown.agreement = judged.agreement;
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
    const GrowShapeOptions& options_;
    double threshold_;
};

}  // namespace

GrownShape grow_shape(const Shape& shape, const PointSet& seeds, const GrowShapeOptions& options)
{
    return ShapeGrowth(seeds, options).run(shape);
}

}  // namespace pcm
