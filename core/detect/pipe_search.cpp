#include "pcm/detect/pipe_search.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/lone_pipe.h"
#include "pcm/detect/seed_order.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/pipe_start.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/shapes/axis_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::array<std::size_t, 3> line_sizes{48, 96, 192};  // points of patches that are tried in turn

class PipeSearch {
public:
    PipeSearch(const SurfaceSample& sample, const PipeSearchOptions& options, std::vector<std::uint8_t>& taken)
        : sample_(sample), options_(options), growth_(sample, taken), tried_(sample.size(), 0)
    {
    }

    std::vector<FoundShape> run()
    {
        std::vector<FoundShape> found;
        std::size_t count = 0;
        for (const std::uint32_t seed :
             seeds_in_order(sample_, growth_, options_.seed, [](std::uint32_t) { return 0; })) {
            if (options_.check && ++count % 64 == 0) options_.check();
            if (!growth_.is_free(seed) || tried_[seed]) continue;
            FoundShape pipe = pipe_from(seed);
            if (pipe.points.empty()) continue;
            growth_.take(pipe, limits(pipe.threshold));
            found.push_back(std::move(pipe));
        }
        return found;
    }

private:
    GrowthLimits limits(double threshold) const { return {threshold, -1, options_.least}; }

    // Without points where there is none.
    FoundShape pipe_from(std::uint32_t seed)
    {
        const std::vector<std::uint32_t> all = growth_.patch(seed, line_sizes.back(), -1);
        for (std::size_t i = 0; i < std::min(all.size(), tuned_.tried_points); ++i) tried_[all[i]] = 1;
        for (const std::size_t size : line_sizes) {
            if (all.size() < size) break;
            const std::vector<std::uint32_t> patch(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(size));
            FoundShape pipe = pipe_from(patch);
            if (!pipe.points.empty()) return pipe;
        }
        return {};
    }

    FoundShape pipe_from(const std::vector<std::uint32_t>& patch)
    {
        const std::vector<Vec3d> points = places_of(sample_, patch);
        const auto line = line_of(points, tuned_.min_elongation);
        const auto start = line ? cylinder_along(*line, points) : std::nullopt;
        if (!start) return {};
        const ShapeFit fit = refine_shape(FitPoints::of(points), *start);
        if (!fit.has_shape() || fit.shape.radius > extent_along(fit.shape.axis, points)) return {};
        const double threshold = tuned_.kept_threshold * visible_threshold(fit.shape, points, options_.threshold);
        if (threshold < tuned_.min_noises * options_.noise) return {};
        FoundShape pipe = growth_.grow(fit.shape, patch, limits(threshold));
        if (pipe.points.size() < options_.least || !is_lone_pipe(sample_, growth_, pipe, tuned_.min_turn)) return {};
        pipe.thin = true;
        return pipe;
    }

    const SurfaceSample& sample_;
    const PipeSearchOptions& options_;
    const PipeTuning& tuned_ = detect_tuning().pipes;
    ShapeGrowth growth_;
    std::vector<std::uint8_t> tried_;
};

}  // namespace

std::vector<FoundShape> search_pipes(const SurfaceSample& sample, const PipeSearchOptions& options,
                                     std::vector<std::uint8_t>& taken)
{
    return PipeSearch(sample, options, taken).run();
}

}  // namespace pcm
