#include "pcm/detect/shape_search.h"

#include "pcm/detect/local_surface.h"
#include "pcm/detect/sagitta.h"
#include "pcm/detect/seed_order.h"
#include "pcm/detect/tuning.h"

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
            growth_.take(best, limits_);
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
        return best;
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
