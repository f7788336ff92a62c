#include "pcm/detect/part_joining.h"

#include "pcm/cloud/growing_box_tree.h"
#include "pcm/cloud/numbers.h"
#include "pcm/detect/hypotheses.h"
#include "pcm/detect/refined_shape.h"
#include "pcm/detect/tuning.h"
#include "pcm/detect/unit_parts.h"
#include "pcm/shapes/flat_hull.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t least_used = 20;  // points that a plane is fitted to
constexpr std::size_t most_used = 512;

// Every second point, from this one on.
std::vector<Vec3d> every_second(const std::vector<Vec3d>& points, std::size_t first)
{
    std::vector<Vec3d> some;
    for (std::size_t i = first; i < points.size(); i += 2) some.push_back(points[i]);
    return some;
}

std::optional<Shape> refined(const Shape& start, const std::vector<Vec3d>& points, double threshold)
{
    if (points.size() < least_used / 2) return std::nullopt;
    return refined_shape(points, start, threshold);
}

bool have_most_of_hull(const Shape& plane, const std::vector<Vec3d>& one, const std::vector<Vec3d>& other,
                       double most_gap)
{
    std::vector<Vec3d> both = one;
    both.insert(both.end(), other.begin(), other.end());
    const FlatHull first(one, plane), second(other, plane);
    return std::max(first.gap_to(second), second.gap_to(first)) <= most_gap &&
           first.area() + second.area() >= detect_tuning().joining.min_filled * FlatHull(both, plane).area();
}

// Whether points that a plane was not fitted to lie on it as on their own.
bool is_on(const Shape& plane, const std::vector<Vec3d>& points, double most_rms)
{
    return rms_distance(plane, every_second(points, 1)) <= most_rms;
}

struct PartOfPlane {
    const Shape& shape;
    double threshold = 0;  // source units
    const std::vector<Vec3d>& points;
};

// The plane of two parts, that of the first one refined; null where they are not on one.
std::optional<Shape> plane_of_both(const PartOfPlane& one, const PartOfPlane& other, const PartJoinOptions& options)
{
    const double threshold = std::max(one.threshold, other.threshold);
    if (!(rms_distance(one.shape, other.points) <= 4 * threshold)) return std::nullopt;
    const auto first = refined(one.shape, one.points, 1.5 * threshold),
               second = refined(other.shape, other.points, 1.5 * threshold);
    if (!first || !second) return std::nullopt;
    std::vector<Vec3d> half = every_second(one.points, 0);
    for (const Vec3d& p : every_second(other.points, 0)) half.push_back(p);
    const auto both = refined(one.shape, half, 6 * threshold);
    if (!both) return std::nullopt;
    const double least = std::cos(std::min(options.normal_angle, pi / 2));
    if (std::fabs(dot(second->axis, both->axis)) < least) return std::nullopt;
    const double own = std::max(rms_distance(*first, one.points), rms_distance(*second, other.points));
    const double share = std::min(detect_tuning().joining.max_rms,
                                  detect_tuning().contest.min_noise * options.noise / options.threshold);
    const double most = std::min(detect_tuning().merging.same_rms * own, share * threshold);
    if (!is_on(*both, one.points, most) || !is_on(*both, other.points, most)) return std::nullopt;
    if (!have_most_of_hull(*both, one.points, other.points, detect_tuning().joining.max_gap * options.spacing))
        return std::nullopt;
    return both;
}

class Joining {
public:
    Joining(AssignedPoints& assigned, std::vector<Hypothesis>& hypotheses, const PartJoinOptions& options)
        : assigned_(assigned), hypotheses_(hypotheses), options_(options), group_(assigned.parts.size())
    {
        std::iota(group_.begin(), group_.end(), 0u);
    }

    void run()
    {
        std::vector<std::uint32_t> order;
        for (std::uint32_t p = 0; p < assigned_.parts.size(); ++p)
            if (can_join(assigned_.parts[p])) order.push_back(p);
        bool is_changed = true;
        while (is_changed) {
            std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
                return assigned_.parts[a].points > assigned_.parts[b].points;
            });
            is_changed = join_once(order);
        }
        pack();
    }

private:
    bool can_join(const SurfacePart& part) const
    {
        const Hypothesis& from = hypotheses_[part.hypothesis];
        return traits_of(from.shape.kind).is_flat() && part.some.size() >= least_used &&
               static_cast<double>(part.mixed) <= tuned_.max_mixed * static_cast<double>(part.sampled);
    }

    // Joins each part to the first of the larger ones that takes it; `order` keeps those that stay.
    bool join_once(std::vector<std::uint32_t>& order)
    {
        std::vector<std::uint32_t> kept;
        GrowingBoxTree reached;  // places in `kept`
        const auto add = [&](std::uint32_t k) {
            Box3d box = assigned_.parts[kept[k]].box;
            const double gap = tuned_.max_gap * options_.spacing;
            for (std::size_t a = 0; a < 3; ++a) box.min[a] -= gap, box.max[a] += gap;
            reached.add(box, k);
        };
        for (const std::uint32_t p : order) {
            const auto takes = [&](std::uint32_t k) { return join(kept[k], p); };
            const std::vector<std::uint32_t> near = reached.touching(assigned_.parts[p].box);
            if (std::any_of(near.begin(), near.end(), takes)) continue;
            kept.push_back(p);
            add(static_cast<std::uint32_t>(kept.size() - 1));
        }
        const bool is_changed = kept.size() < order.size();
        order = std::move(kept);
        return is_changed;
    }

    bool join(std::uint32_t to, std::uint32_t from)
    {
        SurfacePart &one = assigned_.parts[to], &other = assigned_.parts[from];
        const Hypothesis &a = hypotheses_[one.hypothesis], &b = hypotheses_[other.hypothesis];
        const auto plane =
            plane_of_both({a.shape, a.threshold, one.some}, {b.shape, b.threshold, other.some}, options_);
        if (!plane) return false;
        Hypothesis both = a;
        both.shape = *plane;
        both.threshold = std::max(a.threshold, b.threshold);
        both.whole = a.whole && b.whole;
        both.box.extend(b.box);
        hypotheses_.push_back(std::move(both));
        add_to(one, other, most_used);
        one.hypothesis = static_cast<std::uint32_t>(hypotheses_.size() - 1);
        group_[from] = to;
        return true;
    }

    // Leaves out the parts that others have taken.
    void pack()
    {
        std::vector<std::uint32_t> place(assigned_.parts.size());
        std::vector<SurfacePart> parts;
        for (std::uint32_t p = 0; p < group_.size(); ++p) {
            if (group_[p] != p) continue;
            place[p] = static_cast<std::uint32_t>(parts.size());
            parts.push_back(std::move(assigned_.parts[p]));
        }
        for (auto& [number, part] : assigned_.numbers) {
            while (group_[part] != part) part = group_[part];
            part = place[part];
        }
        assigned_.parts = std::move(parts);
    }

    AssignedPoints& assigned_;
    std::vector<Hypothesis>& hypotheses_;
    const PartJoinOptions& options_;
    const JoiningTuning& tuned_ = detect_tuning().joining;
    std::vector<std::uint32_t> group_;  // for each part the one that has taken it, or itself
};

}  // namespace

void join_parts(AssignedPoints& assigned, std::vector<Hypothesis>& hypotheses, const PartJoinOptions& options)
{
    Joining(assigned, hypotheses, options).run();
}

AssignedPoints assign_joined(const ChosenPoints& points, const std::vector<Box3i>& units,
                             std::vector<Hypothesis>& hypotheses, AssignOptions assign, const PartJoinOptions& join,
                             PointLabels* labels)
{
    assign.least_points = std::max<std::uint64_t>(least_used, assign.least_points / 10);
    assign.some_from = 0;
    assign.most_some = most_used;
    AssignedPoints assigned = assign_points(points, units, hypotheses, assign, labels);
    join_parts(assigned, hypotheses, join);
    return assigned;
}

}  // namespace pcm
