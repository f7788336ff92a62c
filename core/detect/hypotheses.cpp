#include "pcm/detect/hypotheses.h"

#include "pcm/cloud/growing_box_tree.h"
#include "pcm/detect/shape_growth.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/shape_fit.h"

#include <algorithm>
#include <cmath>

namespace pcm {

double rms_distance(const Shape& shape, const std::vector<Vec3d>& points)
{
    double squares = 0;
    for (const Vec3d& p : points) {
        const double d = signed_distance(shape, p);
        squares += d * d;
    }
    return points.empty() ? 0 : std::sqrt(squares / static_cast<double>(points.size()));
}

namespace {

bool normals_agree(const Shape& a, const Shape& b, const std::vector<Vec3d>& points, double angle)
{
    const double least = std::cos(std::min(angle, pi / 2));
    for (const Vec3d& p : points)
        if (std::fabs(dot(normal_at(a, p), normal_at(b, p))) < least) return false;
    return true;
}

// Evenly those of both, as many as one may have.
std::vector<Vec3d> some_of(const Hypothesis& a, const Hypothesis& b)
{
    std::vector<Vec3d> all = a.some, some;
    all.insert(all.end(), b.some.begin(), b.some.end());
    const std::size_t most = 2 * hypothesis_points;
    if (all.size() <= most) return all;
    for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
    return some;
}

// Takes `other`, which `one` reaches, into it, if both are the same surface.
bool absorb(Hypothesis& one, const Hypothesis& other, const MergeOptions& options)
{
    if (one.shape.kind != other.shape.kind) return false;
    const double threshold = std::max(one.threshold, other.threshold);
    const double most = detect_tuning().merging.same_rms * std::max({one.rms, other.rms, 0.02 * threshold});
    double apart = rms_distance(one.shape, other.some);
    if (!(apart <= 4 * threshold) || !normals_agree(one.shape, other.shape, other.some, options.normal_angle))
        return false;
    std::vector<Vec3d> some = some_of(one, other);
    RefineOptions refine;
    refine.threshold = 6 * threshold;
    refine.most_steps = 10;
    const ShapeFit fit = refine_shape(FitPoints::of(some), one.shape, refine);
    if (!fit.has_shape() || rms_distance(fit.shape, other.some) > most || rms_distance(fit.shape, one.some) > most)
        return false;
    one.shape = fit.shape;
    one.box.extend(other.box);
    one.area += other.area;
    one.threshold = threshold;
    one.reach = std::max(one.reach, other.reach);
    one.rms = rms_distance(fit.shape, some);
    one.some = std::move(some);
    return true;
}

// Whether nearly all points of `small` are points of `large` too, which reaches it and may be of another kind, as a
// band of a cylinder that a sphere fits as well.
bool explains(const Hypothesis& large, const Hypothesis& small, const MergeOptions& options)
{
    if (large.area < small.area) return false;
    const double least = std::cos(std::min(options.normal_angle, pi / 2));
    const Box3d box = reached_box(large, options.gap);
    std::size_t on = 0;
    for (const Vec3d& p : small.some)
        on += box.contains(p) && distance_to(large.shape, p) <= large.threshold &&
              std::fabs(dot(normal_at(large.shape, p), normal_at(small.shape, p))) >= least;
    return static_cast<double>(on) >= detect_tuning().merging.explained_share * static_cast<double>(small.some.size());
}

}  // namespace

Box3d reached_box(const Hypothesis& one, double least_reach)
{
    Box3d box = one.box;
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= std::max(one.reach, least_reach);
        box.max[a] += std::max(one.reach, least_reach);
    }
    return box;
}

void mark_explained(const SurfaceSample& sample, const std::vector<Hypothesis>& known, const ExplainedLimits& limits,
                    std::vector<std::uint8_t>& taken)
{
    const double cos_angle = std::cos(std::min(limits.normal_angle, pi / 2));
    for (const Hypothesis& one : known) {
        Shape shape = one.shape;
        shape.point = shape.point - sample.origin;
        const double least_cosine = one.thin ? -1 : cos_angle;
        for_points_near(sample, reached_box(one, limits.reach), shape, limits.threshold, [&](std::uint32_t i) {
            if (!taken[i] && fits(sample, i, shape, limits.threshold, least_cosine)) taken[i] = 1;
        });
    }
}

std::vector<Hypothesis> merged(std::vector<Hypothesis> all, const MergeOptions& options, std::uint64_t* pairs)
{
    for (std::size_t before = all.size() + 1; all.size() < before;) {
        before = all.size();
        std::stable_sort(all.begin(), all.end(),
                         [](const Hypothesis& a, const Hypothesis& b) { return a.area > b.area; });
        std::vector<Hypothesis> kept;
        GrowingBoxTree reached;  // those of `kept`
        const auto reach = [&](std::uint32_t k) { reached.add(reached_box(kept[k], options.gap), k); };
        for (Hypothesis& next : all) {
            const auto takes = [&](std::uint32_t k) {
                if (pairs) ++*pairs;
                if (!absorb(kept[k], next, options)) return explains(kept[k], next, options);
                reach(k);
                return true;
            };
            const std::vector<std::uint32_t> near = reached.touching(next.box);
            if (std::any_of(near.begin(), near.end(), takes)) continue;
            kept.push_back(std::move(next));
            reach(static_cast<std::uint32_t>(kept.size() - 1));
        }
        all = std::move(kept);
    }
    return all;
}

}  // namespace pcm
