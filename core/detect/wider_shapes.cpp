#include "pcm/detect/wider_shapes.h"

#include "pcm/detect/tuning.h"
#include "pcm/fit/shape_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr int doublings = 3;

// A hypothesis' points in a trial.
struct Trial {
    double pieces = 0, whole = 0;  // points of the sample in parts that are pieces, and in others
    const SurfacePart* largest = nullptr;
};

// What a threshold cuts out of ground has points at all distances up to the threshold, or continues somewhere.
bool is_cut_out(const SurfacePart& part, double threshold)
{
    const auto interior = static_cast<double>(part.sampled - part.edge);
    const double open = detect_tuning().widening.max_open_edge, flat = detect_tuning().pieces.flat_rms;
    if (static_cast<double>(part.continued) > open * static_cast<double>(part.edge)) return true;
    return !(part.squares < flat * flat * threshold * threshold * interior);
}

double share_on(const Hypothesis& surface, const std::vector<Vec3d>& points)
{
    const auto on = std::count_if(points.begin(), points.end(),
                                  [&](const Vec3d& p) { return distance_to(surface.shape, p) <= surface.threshold; });
    return static_cast<double>(on) / static_cast<double>(std::max<std::size_t>(1, points.size()));
}

// A trial needs none of its points, which are most of a hypothesis' memory.
Hypothesis without_points(const Hypothesis& one)
{
    Hypothesis copy;
    copy.shape = one.shape;
    copy.box = one.box;
    copy.threshold = one.threshold;
    copy.reach = one.reach;
    copy.thin = one.thin;
    copy.of_strip = one.of_strip;
    copy.whole = one.whole;
    return copy;
}

class Widening {
public:
    Widening(const ChosenPoints& points, std::vector<Hypothesis> all, const WidenOptions& options)
        : points_(points), options_(options), settled_(std::move(all))
    {
        for (AssignOptions* assign : {&options_.fine.assign, &options_.coarse.assign}) {
            assign->least_points = 0;  // no labels, no points: only those of the sample count
            assign->least_sampled = tuned_.min_sampled;
        }
    }

    std::vector<Hypothesis> run()
    {
        std::vector<Hypothesis> bent = take_bent(settled_);
        std::vector<Hypothesis> before = bent;
        const std::vector<Hypothesis> ending = ending_shapes(bent);
        keep_on(ending, bent);
        for (Hypothesis& one : take_beside(ending)) {
            bent.push_back(one);
            before.push_back(std::move(one));
        }
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
    // Shapes that the widest threshold may show whole; ground, which continues beyond any, is not among them. A coarse
    // sample is enough for that.
    std::vector<Hypothesis> ending_shapes(std::vector<Hypothesis> widest)
    {
        std::vector<Hypothesis> ending;
        if (widest.empty()) return ending;
        sample_ = &options_.coarse;
        for (Hypothesis& one : widest) one.threshold *= 1 << doublings;
        fit_to_wider_parts(widest);
        widest = merged(joined(std::move(widest)), options_.merge);
        const std::vector<Trial> trials = trial(widest);
        for (std::size_t w = 0; w < widest.size(); ++w) {
            const Trial& one = trials[settled_.size() + w];
            if (one.pieces <= one.whole) ending.push_back(widest[w]);
        }
        sample_ = &options_.fine;
        return ending;
    }

    // Whether their normals agree where the second has points.
    bool same_normals(const Hypothesis& wide, const Hypothesis& one) const
    {
        const double least = std::cos(std::min(options_.fine.assign.normal_angle, pi / 2));
        return std::all_of(one.some.begin(), one.some.end(), [&](const Vec3d& p) {
            return std::fabs(dot(normal_at(wide.shape, p), normal_at(one.shape, p))) >= least;
        });
    }

    bool lies_on(const Hypothesis& one, const std::vector<Hypothesis>& wide, double least_share) const
    {
        return std::any_of(wide.begin(), wide.end(), [&](const Hypothesis& w) {
            return one.box.intersects(reached_box(w, options_.coarse.assign.reach)) &&
                   share_on(w, one.some) >= least_share;
        });
    }

    void keep_on(const std::vector<Hypothesis>& wide, std::vector<Hypothesis>& some) const
    {
        const auto elsewhere = [&](const Hypothesis& one) { return !lies_on(one, wide, tuned_.kept_share); };
        some.erase(std::remove_if(some.begin(), some.end(), elsewhere), some.end());
    }

    // Takes out of settled_ what the threshold does not cut out, but what a wider shape may contain: an even part of an
    // uneven floor.
    std::vector<Hypothesis> take_beside(const std::vector<Hypothesis>& wide)
    {
        std::vector<Hypothesis> taken, kept;
        for (Hypothesis& one : settled_) {
            const auto alike = [&](const Hypothesis& w) {
                return w.shape.kind == one.shape.kind && lies_on(one, {w}, tuned_.joined_share) && same_normals(w, one);
            };
            (std::any_of(wide.begin(), wide.end(), alike) ? taken : kept).push_back(std::move(one));
        }
        settled_ = std::move(kept);
        return taken;
    }

    // The boxes where points of these may be.
    std::vector<Box3i> units_of(const std::vector<Hypothesis>& some) const
    {
        std::vector<Box3i> units;
        for (const Box3i& unit : sample_->units) {
            const Box3d box = points_.source_box(unit);
            const auto reaches = [&](const Hypothesis& one) {
                return box.intersects(reached_box(one, sample_->assign.reach));
            };
            if (std::any_of(some.begin(), some.end(), reaches)) units.push_back(unit);
        }
        return units;
    }

    // By hypothesis, of those in settled_ and then `more`; where there are more, of these alone.
    std::vector<Trial> trial(const std::vector<Hypothesis>& more, bool keeps_points = false)
    {
        tried_.clear();
        for (const Hypothesis& one : settled_) tried_.push_back(without_points(one));
        for (const Hypothesis& one : more) tried_.push_back(without_points(one));
        const std::vector<Box3i> units = more.empty() ? sample_->units : units_of(more);
        AssignOptions assign = sample_->assign;
        for (const Hypothesis& one : more) assign.sample.only.push_back(vicinity_of(one, assign));
        if (keeps_points) assign.some_from = static_cast<std::uint32_t>(settled_.size());
        assigned_ = assign_points(points_, units, tried_, assign, nullptr);
        std::vector<Trial> trials(tried_.size());
        for (const SurfacePart& part : assigned_.parts) {
            if (part.sampled < tuned_.min_sampled) continue;
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
            (piece && !from[h].whole ? bent : kept).push_back(from[h]);
        }
        from = std::move(kept);
        return bent;
    }

    void fit_to_wider_parts(std::vector<Hypothesis>& bent)
    {
        const std::vector<Trial> trials = trial(bent, true);
        const std::size_t first = tried_.size() - bent.size();
        for (std::size_t h = 0; h < bent.size(); ++h) {
            const SurfacePart* const part = trials[first + h].largest;
            if (!part || part->some.size() < tuned_.min_sampled / 2) continue;
            RefineOptions refine;
            refine.threshold = bent[h].threshold;
            const ShapeFit fit = refine_shape(FitPoints::of(part->some), bent[h].shape, refine);
            if (!fit.has_shape()) continue;
            bent[h].shape = fit.shape;
            bent[h].rms = fit.rms;
            const double cell = sample_->assign.sample.cell;
            bent[h].area = static_cast<double>(part->sampled) * cell * cell;
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
        Hypothesis together = one;
        together.shape = fit.shape;
        const double least = detect_tuning().widening.joined_share;
        if (!fit.has_shape() || share_on(together, one.some) < least || share_on(together, other.some) < least)
            return false;
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
    WidenOptions options_;
    const WideningTuning& tuned_ = detect_tuning().widening;
    const WidenSample* sample_ = &options_.fine;
    std::vector<Hypothesis> settled_, tried_;
    AssignedPoints assigned_;
};

}  // namespace

std::vector<Hypothesis> with_wider_shapes(const ChosenPoints& points, std::vector<Hypothesis> all,
                                          const WidenOptions& options)
{
    return Widening(points, std::move(all), options).run();
}

}  // namespace pcm
