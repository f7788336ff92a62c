#include "pcm/primitives/wider_shapes.h"

#include "pcm/fit/shape_fit.h"

#include <algorithm>
#include <utility>

namespace pcm {
namespace {

constexpr int doublings = 3;
constexpr double joined_share = 0.9;        // of the points of two layers that a shape for both has
constexpr double widest_rms = 0.2;          // of a whole surface, in thresholds
constexpr double most_continued = 0.1;      // share of its edge where it may seem to continue
constexpr std::size_t least_sampled = 100;  // of a part that is looked at

// A hypothesis' points in a trial.
struct Trial {
    double pieces = 0, whole = 0;  // points of the sample in parts that are pieces, and in others
    const SurfacePart* largest = nullptr;
};

// What a threshold cuts out of ground has points at all distances up to the threshold, or continues somewhere.
bool is_cut_out(const SurfacePart& part, double threshold)
{
    const auto interior = static_cast<double>(part.sampled - part.edge);
    if (static_cast<double>(part.continued) > most_continued * static_cast<double>(part.edge)) return true;
    return !(part.squares < widest_rms * widest_rms * threshold * threshold * interior);
}

class Widening {
public:
    Widening(const ChosenPoints& points, const std::vector<Box3i>& units, std::vector<Hypothesis> all,
             const WidenOptions& options)
        : points_(points), units_(units), options_(options), settled_(std::move(all))
    {
        options_.assign.keep_some = true;
    }

    std::vector<Hypothesis> run()
    {
        std::vector<Hypothesis> bent = take_bent(settled_);
        const std::vector<Hypothesis> before = bent;
        std::vector<Hypothesis> found;
        for (int k = 0; k < doublings && !bent.empty(); ++k) {
            for (Hypothesis& one : bent) one.threshold *= 2;
            fit_to_wider_parts(bent);
            bent = merged(joined(std::move(bent)), options_.merge);
            std::vector<Hypothesis> wide = bent;
            bent = take_bent(wide);
            for (Hypothesis& one : wide) one.whole = true;
            found.insert(found.end(), wide.begin(), wide.end());
            settled_.insert(settled_.end(), wide.begin(), wide.end());
        }
        settled_.resize(settled_.size() - found.size());
        found.insert(found.end(), before.begin(), before.end());
        for (Hypothesis& one : merged(std::move(found), options_.merge)) settled_.push_back(std::move(one));
        return std::move(settled_);
    }

private:
    // By hypothesis, of those in settled_ and then `more`.
    std::vector<Trial> trial(const std::vector<Hypothesis>& more)
    {
        tried_ = settled_;
        tried_.insert(tried_.end(), more.begin(), more.end());
        assigned_ = assign_points(points_, units_, tried_, options_.assign, nullptr);
        std::vector<Trial> trials(tried_.size());
        for (const SurfacePart& part : assigned_.parts) {
            if (part.sampled < least_sampled) continue;
            Trial& one = trials[part.hypothesis];
            const bool piece = is_piece(part, tried_[part.hypothesis].threshold);
            (piece ? one.pieces : one.whole) += static_cast<double>(part.sampled);
            if (!one.largest || part.sampled > one.largest->sampled) one.largest = &part;
        }
        return trials;
    }

    // Takes those out that are mostly pieces, or nothing. `from`: settled_, or others.
    std::vector<Hypothesis> take_bent(std::vector<Hypothesis>& from)
    {
        const bool own = &from == &settled_;
        const std::vector<Trial> trials = trial(own ? std::vector<Hypothesis>() : from);
        const std::size_t first = own ? 0 : settled_.size();
        std::vector<Hypothesis> bent, kept;
        for (std::size_t h = 0; h < from.size(); ++h) {
            const Trial& one = trials[first + h];
            const bool piece =
                own ? one.pieces > one.whole : one.pieces >= one.whole || is_cut_out(*one.largest, from[h].threshold);
            (piece ? bent : kept).push_back(from[h]);
        }
        from = std::move(kept);
        return bent;
    }

    void fit_to_wider_parts(std::vector<Hypothesis>& bent)
    {
        const std::vector<Trial> trials = trial(bent);
        const std::size_t first = tried_.size() - bent.size();
        for (std::size_t h = 0; h < bent.size(); ++h) {
            const SurfacePart* const part = trials[first + h].largest;
            if (!part || part->some.size() < least_sampled / 2) continue;
            RefineOptions refine;
            refine.threshold = bent[h].threshold;
            const ShapeFit fit = refine_shape(FitPoints::of(part->some), bent[h].shape, refine);
            if (!fit.has_shape()) continue;
            bent[h].shape = fit.shape;
            bent[h].rms = fit.rms;
            bent[h].area =
                static_cast<double>(part->sampled) * options_.assign.sample.cell * options_.assign.sample.cell;
            bent[h].some.clear();
            for (std::size_t i = 0; i < hypothesis_points; ++i)
                bent[h].some.push_back(part->some[i * part->some.size() / hypothesis_points]);
            bent[h].box.extend(part->box);
        }
    }

    // Layers of one surface that lie within a wide threshold of one shape share their points in a trial: each shape
    // would keep its own half.
    std::vector<Hypothesis> joined(std::vector<Hypothesis> bent) const
    {
        std::stable_sort(bent.begin(), bent.end(),
                         [](const Hypothesis& a, const Hypothesis& b) { return a.area > b.area; });
        std::vector<Hypothesis> kept;
        for (Hypothesis& next : bent)
            if (std::none_of(kept.begin(), kept.end(), [&](Hypothesis& one) { return join(one, next); }))
                kept.push_back(std::move(next));
        return kept;
    }

    static bool join(Hypothesis& one, const Hypothesis& other)
    {
        if (one.shape.kind != other.shape.kind) return false;
        for (std::size_t a = 0; a < 3; ++a)
            if (one.box.min[a] > other.box.max[a] + one.threshold || other.box.min[a] > one.box.max[a] + one.threshold)
                return false;
        std::vector<Vec3d> both = one.some;
        both.insert(both.end(), other.some.begin(), other.some.end());
        RefineOptions refine;
        refine.threshold = 2 * one.threshold;
        const ShapeFit fit = refine_shape(FitPoints::of(both), one.shape, refine);
        const auto share = [&](const std::vector<Vec3d>& points) {
            const auto on = std::count_if(points.begin(), points.end(),
                                          [&](const Vec3d& p) { return distance_to(fit.shape, p) <= one.threshold; });
            return static_cast<double>(on) / static_cast<double>(points.size());
        };
        if (!fit.has_shape() || share(one.some) < joined_share || share(other.some) < joined_share) return false;
        one.shape = fit.shape;
        one.rms = fit.rms;
        one.box.extend(other.box);
        one.area += other.area;
        for (std::size_t i = 0; i < both.size() / 2; ++i) both[i] = both[2 * i];
        both.resize(both.size() / 2);
        one.some = std::move(both);
        return true;
    }

    const ChosenPoints& points_;
    const std::vector<Box3i>& units_;
    WidenOptions options_;
    std::vector<Hypothesis> settled_, tried_;
    AssignedPoints assigned_;
};

}  // namespace

std::vector<Hypothesis> with_wider_shapes(const ChosenPoints& points, const std::vector<Box3i>& units,
                                          std::vector<Hypothesis> all, const WidenOptions& options)
{
    return Widening(points, units, std::move(all), options).run();
}

}  // namespace pcm
