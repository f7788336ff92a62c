#include "pcm/detect/shape_search.h"

#include "pcm/detect/local_surface.h"
#include "pcm/detect/sagitta.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/shape_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t refit_points = 1500;  // maximum for another fit of a shape while it grows

std::uint64_t mixed(std::uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

class Search {
public:
    Search(const SurfaceSample& sample, const ShapeSearchOptions& options, std::vector<std::uint8_t>& taken)
        : sample_(sample),
          options_(options),
          taken_(taken),
          cos_angle_(std::cos(std::min(options.normal_angle, pi / 2))),
          tried_(sample.size(), 0),
          seen_(sample.size(), 0)
    {
    }

    std::vector<FoundShape> run()
    {
        std::vector<FoundShape> found;
        std::size_t count = 0;
        for (const std::uint32_t seed : seeds()) {
            if (options_.check && ++count % 64 == 0) options_.check();
            if (taken_[seed] || tried_[seed]) continue;
            FoundShape best = best_from(seed);
            if (best.points.size() < options_.least) continue;
            take(best);
            found.push_back(std::move(best));
        }
        return found;
    }

private:
    // Smooth places first.
    std::vector<std::uint32_t> seeds() const
    {
        std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
        for (std::uint32_t i = 0; i < sample_.size(); ++i) {
            if (taken_[i] || !sample_.inside[i]) continue;
            const double rough = sample_.rough[i] / options_.threshold;
            const auto bin = static_cast<std::uint64_t>(std::clamp(rough * 8, 0.0, 63.0));
            order.push_back({bin << 56 | mixed(i * 2654435761u + options_.seed) >> 8, i});
        }
        std::sort(order.begin(), order.end());
        std::vector<std::uint32_t> seeds;
        for (const auto& entry : order) seeds.push_back(entry.second);
        return seeds;
    }

    // Also the points next to it that its noise may have put there: they are not a shape of their own.
    void take(const FoundShape& found)
    {
        const double shadow = tuned_.shadow * options_.threshold;
        for (const std::uint32_t i : found.points) taken_[i] = 1;
        std::vector<std::uint32_t> open = found.points;
        while (!open.empty()) {
            const std::uint32_t* const near = sample_.neighbours(open.back());
            open.pop_back();
            for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
                const std::uint32_t j = near[k];
                if (taken_[j] || !fits(sample_, j, found.shape, shadow, cos_angle_)) continue;
                taken_[j] = 1;
                open.push_back(j);
            }
        }
    }

    // Up to `most` free points around the seed, in the order of edges.
    std::vector<std::uint32_t> patch(std::uint32_t seed, std::size_t most)
    {
        ++stamp_;
        std::vector<std::uint32_t> points{seed};
        seen_[seed] = stamp_;
        const Vec3d normal = sample_.normal_of(seed);
        for (std::size_t next = 0; next < points.size() && points.size() < most; ++next) {
            const std::uint32_t* const near = sample_.neighbours(points[next]);
            for (std::size_t k = 0; k < SurfaceSample::most_neighbours && points.size() < most; ++k) {
                const std::uint32_t j = near[k];
                if (seen_[j] == stamp_ || taken_[j]) continue;
                seen_[j] = stamp_;
                if (std::fabs(dot(sample_.normal_of(j), normal)) >= 0.5) points.push_back(j);
            }
        }
        return points;
    }

    FoundShape best_from(std::uint32_t seed)
    {
        const std::vector<std::uint32_t> points = patch(seed, patch_sizes.back());
        for (std::size_t i = 0; i < std::min(points.size(), tuned_.tried_points); ++i) tried_[points[i]] = 1;
        std::optional<LocalSurface> surface;
        std::size_t used = 0;
        for (const std::size_t size : patch_sizes) {
            const std::size_t count = std::min(size, points.size());
            if (count <= used) break;
            const auto here = fit_local_surface(sample_, points.data(), count, options_.threshold);
            if (!here || here->near < tuned_.smooth_share || here->rms > tuned_.max_rough * options_.threshold) break;
            surface = here;
            used = count;
        }
        FoundShape best;
        if (!surface) return best;
        std::size_t plane = 0;
        for (const Shape& shape : shapes_like(*surface, options_.kinds)) {
            FoundShape grown = grow(shape, {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(used)});
            const bool flat = traits_of(shape.kind).is_flat();
            if (flat) plane = grown.points.size();
            if (grown.points.size() < options_.least) continue;
            if (!flat && (static_cast<double>(grown.points.size()) < tuned_.curved_gain * static_cast<double>(plane) ||
                          !is_curved(grown)))
                continue;
            if (grown.points.size() > best.points.size()) best = std::move(grown);
        }
        return best;
    }

    // Whether the normals of the points turn too much for a plane.
    bool is_curved(const FoundShape& found) const
    {
        std::vector<Vec3d> at;
        for (const std::uint32_t i : found.points) at.push_back(sample_.at[i]);
        const double turn = turn_of(found.shape, at);
        return turn > tuned_.min_arc && sagitta_of(found.shape, turn) >= options_.least_sagitta;
    }

    bool fits_here(std::uint32_t i, const Shape& shape) const
    {
        return fits(sample_, i, shape, options_.threshold, cos_angle_);
    }

    // Least squares of some of the points; false where they determine no shape.
    bool refit(Shape& shape, const std::vector<std::uint32_t>& points) const
    {
        FitPoints some;
        const std::size_t step = std::max<std::size_t>(1, points.size() / refit_points);
        for (std::size_t i = 0; i < points.size(); i += step) some.add(sample_.at[points[i]]);
        RefineOptions refine;
        refine.threshold = 1.5 * options_.threshold;
        refine.most_steps = 8;
        const ShapeFit fit = refine_shape(some, shape, refine);
        if (!fit.has_shape() || !is_finite(fit.shape.point)) return false;
        shape = fit.shape;
        return true;
    }

    // All free points that edges reach from `from` through points that fit; the shape is fitted again on the way.
    std::vector<std::uint32_t> reach(Shape& shape, const std::vector<std::uint32_t>& from, bool refits)
    {
        ++stamp_;
        std::vector<std::uint32_t> points;
        for (const std::uint32_t i : from)
            if (seen_[i] != stamp_ && fits_here(i, shape)) {
                seen_[i] = stamp_;
                points.push_back(i);
            }
        std::size_t fitted = points.size();
        for (std::size_t next = 0; next < points.size(); ++next) {
            if (refits && points.size() >= 2 * fitted) {
                if (!refit(shape, points)) return {};
                fitted = points.size();
            }
            const std::uint32_t* const near = sample_.neighbours(points[next]);
            for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
                const std::uint32_t j = near[k];
                if (seen_[j] == stamp_ || taken_[j] || !fits_here(j, shape)) continue;
                seen_[j] = stamp_;
                points.push_back(j);
            }
        }
        return points;
    }

    FoundShape grow(Shape shape, const std::vector<std::uint32_t>& from)
    {
        FoundShape found;
        if (!refit(shape, from)) return found;
        std::vector<std::uint32_t> points = reach(shape, from, true);
        for (int round = 0; round < 3 && points.size() >= options_.least; ++round) {
            const std::size_t before = points.size();
            if (!refit(shape, points)) return found;
            points = reach(shape, points, false);
            if (points.size() <= before + before / 50) break;
        }
        if (points.size() < options_.least) return found;
        double squares = 0;
        for (const std::uint32_t i : points) {
            const double d = signed_distance(shape, sample_.at[i]);
            squares += d * d;
        }
        found.rms = std::sqrt(squares / static_cast<double>(points.size()));
        found.shape = shape;
        found.points = std::move(points);
        return found;
    }

    const SurfaceSample& sample_;
    const ShapeSearchOptions& options_;
    const ShapeSearchTuning& tuned_ = detect_tuning().search;
    std::vector<std::uint8_t>& taken_;
    const double cos_angle_;
    std::vector<std::uint8_t> tried_;
    std::vector<std::uint32_t> seen_;
    std::uint32_t stamp_ = 0;
};

}  // namespace

bool fits(const SurfaceSample& sample, std::size_t point, const Shape& shape, double threshold, double cos_angle)
{
    const Vec3d& p = sample.at[point];
    return distance_to(shape, p) <= threshold &&
           std::fabs(dot(sample.normal_of(point), normal_at(shape, p))) >= cos_angle;
}

std::vector<FoundShape> search_shapes(const SurfaceSample& sample, const ShapeSearchOptions& options,
                                      std::vector<std::uint8_t>& taken)
{
    return Search(sample, options, taken).run();
}

}  // namespace pcm
