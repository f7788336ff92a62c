#include "pcm/fit/patch_sums.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcm {
namespace {

// Distances of points that count, in separate bins, so that one need not wait for the one before.
class DistanceCounts {
public:
    void add(const PatchBlock& block, const BlockWeights& weights, std::size_t count, double threshold)
    {
        std::int32_t at[patch_block];
        block_loops().find_bins(block, count, threshold, DistanceBins::size, at);
        for (std::size_t i = 0; i < count; ++i)
            counts_[i % apart][static_cast<std::size_t>(at[i])] += weights.within[i];
    }
    void add_to(DistanceBins& bins) const
    {
        for (std::size_t i = 0; i < DistanceBins::size; ++i)
            for (const auto& counts : counts_) bins.counts[i] += counts[i];
    }

private:
    static constexpr std::size_t apart = 2;
    std::array<std::array<double, DistanceBins::size + 1>, apart> counts_{};
};

// Returns how many count.
double weigh(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, const PatchBand& band,
             const NoiseMixture* mixture, std::size_t first, std::size_t count, const PatchBlock& block,
             BlockWeights& weights)
{
    const BlockLoops& loops = block_loops();
    double near = loops.within(block, count, band.threshold, weights);
    if (band.least_cosine > 0)
        near -= take_away_other_normals(model.shape_of(patch), points, band.least_cosine, first, count, weights.within);
    const double* support = band.support ? band.support + first : nullptr;
    if (mixture && !mixture->all_belong())
        loops.weigh(block, count, mixture->table(), support, weights);
    else if (mixture && std::isfinite(band.threshold))
        loops.weigh_tapered(block, count, NoiseMixture::taper_from * band.threshold, band.threshold, support, weights);
    else
        loops.weigh_alike(block, count, std::isfinite(band.threshold) ? band.threshold * band.threshold : 0, weights);
    return near;
}

void add_to(PatchSums& sums, const BlockSums& other)
{
    sums.used += other.used;
    sums.slope += other.slope;
    sums.squares += other.squares;
    sums.pull += other.pull;
    for (std::size_t j = 0; j < sums.parameters; ++j) {
        sums.gradient[j] += other.gradient[j];
        for (std::size_t k = j; k < sums.parameters; ++k)
            sums.products[j * most_parameters + k] += other.products[j * most_parameters + k];
    }
}

}  // namespace

double take_away_other_normals(const Shape& shape, const WorkingPoints& points, double least_cosine, std::size_t first,
                               std::size_t count, double* within)
{
    if (!(least_cosine > 0) || !points.has_normals()) return 0;
    double taken = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d normal = points.normal(first + i);
        if (within[i] > 0 && dot(normal, normal) > 0 &&
            std::fabs(dot(normal, normal_at(shape, points.at(first + i)))) < least_cosine) {
            within[i] = 0;
            taken += 1;
        }
    }
    return taken;
}

void add_to(PatchSums& sums, const PatchBlock& block, std::size_t i)
{
    const double d = block.distance[i];
    sums.used += 1;
    sums.slope += 1;
    ++sums.inliers;
    sums.squares += d * d;
    sums.pull += d * d;
    for (std::size_t j = 0; j < sums.parameters; ++j) {
        const double by = block.by[j][i];
        sums.gradient[j] += by * d;
        for (std::size_t k = j; k < sums.parameters; ++k) sums.products[j * most_parameters + k] += by * block.by[k][i];
    }
}

void add_to(PatchSums& sums, const PatchSums& other)
{
    sums.used += other.used;
    sums.slope += other.slope;
    sums.inliers += other.inliers;
    sums.squares += other.squares;
    sums.pull += other.pull;
    sums.cost += other.cost;
    for (std::size_t j = 0; j < sums.gradient.size(); ++j) sums.gradient[j] += other.gradient[j];
    for (std::size_t j = 0; j < sums.products.size(); ++j) sums.products[j] += other.products[j];
}

void take_from(PatchSums& sums, const PatchSums& other)
{
    sums.used -= other.used;
    sums.slope -= other.slope;
    sums.inliers -= std::min(sums.inliers, other.inliers);
    sums.squares -= other.squares;
    sums.pull -= other.pull;
    sums.cost -= other.cost;
    for (std::size_t j = 0; j < sums.gradient.size(); ++j) sums.gradient[j] -= other.gradient[j];
    for (std::size_t j = 0; j < sums.products.size(); ++j) sums.products[j] -= other.products[j];
}

PatchSums sums_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points,
                  const PatchBand& band, const NoiseMixture* mixture, DistanceBins* bins)
{
    PatchSums sums;
    sums.parameters = model.parameters();
    const std::size_t n = std::min(points.size(), band.points);
    const BlockLoops& loops = block_loops();
    const bool counted = bins && mixture && mixture->needs_bins();
    DistanceCounts counts;
    PatchBlock block;
    BlockWeights weights;
    BlockSums block_sums;
    for (std::size_t first = 0; first < n; first += patch_block) {
        const std::size_t count = std::min(patch_block, n - first);
        model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
        const double near = weigh(model, patch, points, band, mixture, first, count, block, weights);
        if (counted) counts.add(block, weights, count, band.threshold);
        sums.cost += loops.cost(weights, count);
        sums.inliers += static_cast<std::uint64_t>(near);
        if (!(near > 0)) continue;
        loops.sum(block, weights, count, sums.parameters, block_sums);
        add_to(sums, block_sums);
    }
    if (counted) counts.add_to(*bins);
    return sums;
}

bool scatter_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, const PatchBand& band,
                const NoiseMixture& mixture, std::array<double, most_parameters * most_parameters>& scatter)
{
    constexpr std::size_t across = 8, least_blocks = 24;
    PatchBlock block;
    BlockWeights weights;
    Vec3d low{1, 1, 1}, high{-1, -1, -1};
    std::vector<std::array<double, most_parameters>> pulls(across * across * across);
    std::vector<bool> filled(pulls.size());
    // First where they are.
    for (const bool summed : {false, true})
        for (std::size_t first = 0; first < points.size(); first += patch_block) {
            const std::size_t count = std::min(patch_block, points.size() - first);
            model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
            weigh(model, patch, points, band, &mixture, first, count, block, weights);
            const double extent = largest_magnitude(high - low);
            for (std::size_t i = 0; i < count; ++i) {
                if (!(weights.weight[i] > 0)) continue;
                const Vec3d p = points.at(first + i);
                std::size_t at = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    if (summed) {
                        const double place = extent > 0 ? (p[k] - low[k]) / extent * across : 0;
                        at = across * at + std::min(across - 1, static_cast<std::size_t>(place));
                    }
                    low[k] = std::min(low[k], p[k]);
                    high[k] = std::max(high[k], p[k]);
                }
                if (!summed) continue;
                filled[at] = true;
                for (std::size_t j = 0; j < model.parameters(); ++j)
                    pulls[at][j] += weights.weight[i] * block.distance[i] * block.by[j][i];
            }
        }
    const auto blocks = static_cast<double>(std::count(filled.begin(), filled.end(), true));
    if (blocks < static_cast<double>(least_blocks)) return false;
    scatter.fill(0);
    for (const auto& pull : pulls)
        for (std::size_t j = 0; j < model.parameters(); ++j)
            for (std::size_t k = 0; k < model.parameters(); ++k)
                scatter[j * most_parameters + k] += pull[j] * pull[k] * blocks / (blocks - 1);
    return true;
}

BandFacts facts_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, double threshold,
                   const double* inverse)
{
    BlockFacts facts{};
    PatchBlock block;
    for (std::size_t first = 0; first < points.size(); first += patch_block) {
        const std::size_t count = std::min(patch_block, points.size() - first);
        model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
        block_loops().facts(block, count, model.parameters(), inverse, threshold, facts);
    }
    if (!(facts.within > 0) || !(facts.sum > 0)) return {};
    return {std::min(1.0, facts.around / 2 / facts.within), facts.largest * facts.within / facts.sum};
}

std::array<double, most_parameters> parameter_units(const ShapeModel& model, double extent)
{
    std::array<double, most_parameters> units{};
    for (std::size_t j = 0; j < model.parameters(); ++j) units[j] = std::pow(extent, model.dimension[j] - 1);
    return units;
}

}  // namespace pcm
