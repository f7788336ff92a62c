#include "pcm/detect/shape_search.h"

#include "pcm/detect/local_surface.h"
#include "pcm/detect/lone_pipe.h"
#include "pcm/detect/sagitta.h"
#include "pcm/detect/seed_order.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/pipe_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr double patch_cosine = 0.5;  // between normals of a patch and of its seed

class Search {
public:
    Search(const SurfaceSample& sample, const ShapeSearchOptions& options, std::vector<std::uint8_t>& taken)
        : sample_(sample),
          options_(options),
          limits_{options.threshold, std::cos(std::min(options.normal_angle, pi / 2)), options.least},
          growth_(sample, taken),
          tried_(sample.size(), 0)
    {
    }

    std::vector<FoundShape> run()
    {
        std::vector<FoundShape> found;
        std::size_t count = 0;
        // Smooth places first.
        const auto rank = [&](std::uint32_t i) { return 8 * sample_.rough[i] / options_.threshold; };
        for (const std::uint32_t seed : seeds_in_order(sample_, growth_, options_.seed, rank)) {
            if (options_.check && ++count % 64 == 0) options_.check();
            if (!growth_.is_free(seed) || tried_[seed]) continue;
            FoundShape best = best_from(seed);
            if (best.points.size() < options_.least) continue;
            growth_.take(best, best.thin ? without_normals() : limits_);
            found.push_back(std::move(best));
        }
        return found;
    }

private:
    FoundShape best_from(std::uint32_t seed)
    {
        const std::vector<std::uint32_t> points = growth_.patch(seed, patch_sizes.back(), patch_cosine);
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
        const std::vector<std::uint32_t> from(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(used));
        std::size_t plane = 0;
        for (const Shape& shape : shapes_like(*surface, options_.kinds)) {
            FoundShape grown = growth_.grow(shape, from, limits_);
            const bool flat = traits_of(shape.kind).is_flat();
            if (flat) plane = grown.points.size();
            if (grown.points.size() < options_.least) continue;
            if (!flat && (static_cast<double>(grown.points.size()) < tuned_.curved_gain * static_cast<double>(plane) ||
                          !is_curved(grown)))
                continue;
            if (grown.points.size() > best.points.size()) best = std::move(grown);
        }
        if (options_.pipes_of_strips && !best.points.empty() && traits_of(best.shape.kind).is_flat()) {
            FoundShape pipe = pipe_along(best);
            const double least = tuned_.curved_gain * static_cast<double>(best.points.size());
            if (static_cast<double>(pipe.points.size()) >= least && is_curved(pipe)) return pipe;
        }
        return best;
    }

    // The cylinder that a plane longer than wide is cut out of, if it bends across; patches that are as wide as a pipe
    // do not show its curvature, and those that are narrower are too few points.
    FoundShape pipe_along(const FoundShape& strip)
    {
        const std::vector<Vec3d> points = places_of(sample_, strip.points);
        const auto line = line_of(points, detect_tuning().pipes.min_elongation);
        const auto start = line ? cylinder_along(*line, points) : std::nullopt;
        if (!start) return {};
        const double width = extent_along(normalised(cross(line->axis, normal_at(strip.shape, line->middle))), points);
        const double bend = width * width / (8 * start->radius);
        if (bend < tuned_.min_strip_bend * options_.threshold) return {};
        const bool thin = start->radius < tuned_.thin_spacings * spacing_of(strip.points);
        FoundShape pipe = growth_.grow(*start, strip.points, thin ? without_normals() : limits_);
        if (thin && !pipe.points.empty()) {
            pipe = growth_.grow_around(pipe, without_normals());
            if (pipe.points.empty() || !is_lone_pipe(sample_, growth_, pipe, tuned_.min_arc)) return {};
        }
        pipe.thin = thin;
        pipe.of_strip = true;
        return pipe;
    }

    GrowthLimits without_normals() const { return {limits_.threshold, -1, limits_.least}; }

    // The median over some of the points.
    double spacing_of(const std::vector<std::uint32_t>& points) const
    {
        std::vector<float> spacings;
        for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 64)
            spacings.push_back(sample_.spacing[points[i]]);
        const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
        std::nth_element(spacings.begin(), middle, spacings.end());
        return *middle;
    }

    // Whether the normals of the points turn too much for a plane.
    bool is_curved(const FoundShape& found) const
    {
        const double turn = turn_of(found.shape, places_of(sample_, found.points));
        return turn > tuned_.min_arc && sagitta_of(found.shape, turn) >= options_.least_sagitta;
    }

    const SurfaceSample& sample_;
    const ShapeSearchOptions& options_;
    const ShapeSearchTuning& tuned_ = detect_tuning().search;
    const GrowthLimits limits_;
    ShapeGrowth growth_;
    std::vector<std::uint8_t> tried_;
};

}  // namespace

std::vector<FoundShape> search_shapes(const SurfaceSample& sample, const ShapeSearchOptions& options,
                                      std::vector<std::uint8_t>& taken)
{
    return Search(sample, options, taken).run();
}

}  // namespace pcm
