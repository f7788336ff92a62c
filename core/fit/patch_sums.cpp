#include "pcm/fit/patch_sums.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcm {
namespace {

// Sums are kept in lanes, which vectors add at once, always in this order.
constexpr std::size_t lanes = 8;

double sum_of_products(const double* a, const double* b, std::size_t count)
{
    double sums[lanes] = {};
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane) sums[lane] += a[i + lane] * b[i + lane];
    for (; i < count; ++i) sums[i % lanes] += a[i] * b[i];
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

double sum_of(const double* a, std::size_t count)
{
    double sums[lanes] = {};
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane) sums[lane] += a[i + lane];
    for (; i < count; ++i) sums[i % lanes] += a[i];
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

void take_away_other_normals(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points,
                             double least_cosine, std::size_t first, std::size_t count, double* within)
{
    const Shape shape = model.shape_of(patch);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d normal = points.normal(first + i);
        if (within[i] > 0 && dot(normal, normal) > 0 &&
            std::fabs(dot(normal, normal_at(shape, points.at(first + i)))) < least_cosine)
            within[i] = 0;
    }
}

struct BlockSums {
    alignas(64) double within[patch_block];  // 1 for points that take part
    alignas(64) double weight[patch_block];
    alignas(64) double slope[patch_block];
    alignas(64) double cost[patch_block];
    alignas(64) double weighted[patch_block];
    alignas(64) double squares[patch_block];

    void weigh_alike(const PatchBlock& block, std::size_t count, double beyond)
    {
        for (std::size_t i = 0; i < count; ++i) {
            const double d = block.distance[i];
            weight[i] = slope[i] = within[i];
            cost[i] = within[i] > 0 ? d * d : beyond;
        }
    }

    void weigh(const PatchBlock& block, std::size_t count, const NoiseMixture& mixture, const double* support,
               double* bins)
    {
        const double step = mixture.table_step(), per_length = 1 / step, beyond = mixture.cost_beyond();
        const NoiseMixture::Row* table = mixture.table().data();
        for (std::size_t i = 0; i < count; ++i) {
            const double away = std::fabs(block.distance[i]), at = away * per_length;
            const double place = at < static_cast<double>(NoiseMixture::table_size) ? at : NoiseMixture::table_size;
            const auto k = static_cast<std::int32_t>(place);
            const NoiseMixture::Row& row = table[k];
            const double from = k * step, past = away - from, by = row.weight + past * row.grows;
            const double part = support ? within[i] * support[i] : within[i];
            weight[i] = part * by;
            slope[i] = part * (by + away * row.grows);
            const double of_it =
                row.cost +
                past * (2 * from * row.weight + past * (from * row.grows + row.weight + past * row.grows * (2.0 / 3)));
            cost[i] = part * of_it + (1 - part) * beyond;
            constexpr std::int32_t rows_per_bin = NoiseMixture::table_size / DistanceBins::size;
            if (bins) bins[k / rows_per_bin] += part;
        }
    }

    // Returns how many take part.
    double weigh(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, const PatchBand& band,
                 const NoiseMixture* mixture, std::size_t first, std::size_t count, const PatchBlock& block,
                 double* bins)
    {
        for (std::size_t i = 0; i < count; ++i) within[i] = std::fabs(block.distance[i]) <= band.threshold ? 1 : 0;
        if (band.least_cosine > 0 && points.has_normals())
            take_away_other_normals(model, patch, points, band.least_cosine, first, count, within);
        const double near = sum_of(within, count);
        if (mixture && mixture->table_step() > 0)
            weigh(block, count, *mixture, band.support ? band.support + first : nullptr, bins);
        else
            weigh_alike(block, count, std::isfinite(band.threshold) ? band.threshold * band.threshold : 0);
        return near;
    }

    void add(PatchSums& sums, PatchBlock& block, std::size_t count)
    {
        const double* distance = block.distance;
        for (std::size_t i = 0; i < count; ++i) weighted[i] = weight[i] * distance[i];
        sums.used += sum_of(weight, count);
        sums.slope += sum_of(slope, count);
        sums.squares += sum_of_products(weighted, distance, count);
        sums.pull += sum_of_products(weighted, weighted, count);
        for (std::size_t j = 0; j < sums.parameters; ++j) {
            sums.gradient[j] += sum_of_products(weighted, block.by[j], count);
            for (std::size_t i = 0; i < count; ++i) squares[i] = weight[i] * block.by[j][i];
            for (std::size_t k = j; k < sums.parameters; ++k)
                sums.products[j * most_parameters + k] += sum_of_products(squares, block.by[k], count);
        }
    }
};

}  // namespace

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

PatchSums sums_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points,
                  const PatchBand& band, const NoiseMixture* mixture, DistanceBins* bins)
{
    PatchSums sums;
    sums.parameters = model.parameters;
    const std::size_t n = std::min(points.size(), band.points);
    double counts[DistanceBins::size + 1] = {};
    PatchBlock block;
    BlockSums block_sums;
    for (std::size_t first = 0; first < n; first += patch_block) {
        const std::size_t count = std::min(patch_block, n - first);
        model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
        const double near =
            block_sums.weigh(model, patch, points, band, mixture, first, count, block, bins ? counts : nullptr);
        sums.cost += sum_of(block_sums.cost, count);
        sums.inliers += static_cast<std::uint64_t>(near);
        if (near > 0) block_sums.add(sums, block, count);
    }
    for (std::size_t i = 0; bins && i < DistanceBins::size; ++i) bins->counts[i] += counts[i];
    return sums;
}

bool scatter_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, const PatchBand& band,
                const NoiseMixture& mixture, std::array<double, most_parameters * most_parameters>& scatter)
{
    constexpr std::size_t across = 8, least_blocks = 24;
    PatchBlock block;
    BlockSums block_sums;
    Vec3d low{1, 1, 1}, high{-1, -1, -1};
    std::vector<std::array<double, most_parameters>> pulls(across * across * across);
    std::vector<bool> filled(pulls.size());
    // First where they are.
    for (const bool summed : {false, true})
        for (std::size_t first = 0; first < points.size(); first += patch_block) {
            const std::size_t count = std::min(patch_block, points.size() - first);
            model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
            block_sums.weigh(model, patch, points, band, &mixture, first, count, block, nullptr);
            const double extent = largest_magnitude(high - low);
            for (std::size_t i = 0; i < count; ++i) {
                if (!(block_sums.weight[i] > 0)) continue;
                const Vec3d p = points.at(first + i);
                std::size_t at = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    if (summed)
                        at = across * at +
                             std::min(across - 1, static_cast<std::size_t>((p[k] - low[k]) / extent * across));
                    low[k] = std::min(low[k], p[k]);
                    high[k] = std::max(high[k], p[k]);
                }
                if (!summed) continue;
                filled[at] = true;
                for (std::size_t j = 0; j < model.parameters; ++j)
                    pulls[at][j] += block_sums.weight[i] * block.distance[i] * block.by[j][i];
            }
        }
    const auto blocks = static_cast<double>(std::count(filled.begin(), filled.end(), true));
    if (blocks < static_cast<double>(least_blocks)) return false;
    scatter.fill(0);
    for (const auto& pull : pulls)
        for (std::size_t j = 0; j < model.parameters; ++j)
            for (std::size_t k = 0; k < model.parameters; ++k)
                scatter[j * most_parameters + k] += pull[j] * pull[k] * blocks / (blocks - 1);
    return true;
}

BandFacts facts_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, double threshold,
                   const double* inverse)
{
    const std::size_t p = model.parameters;
    double within = 0, around = 0, sum = 0, largest = 0;
    PatchBlock block;
    for (std::size_t first = 0; first < points.size(); first += patch_block) {
        const std::size_t count = std::min(patch_block, points.size() - first);
        model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
        for (std::size_t i = 0; i < count; ++i) {
            const double away = std::fabs(block.distance[i]);
            if (away > 2 * threshold && away <= 4 * threshold) around += 1;
            if (!(away <= threshold)) continue;
            double influence = 0;
            for (std::size_t j = 0; j < p; ++j)
                for (std::size_t k = 0; k < p; ++k) influence += inverse[j * p + k] * block.by[j][i] * block.by[k][i];
            within += 1;
            sum += influence;
            largest = std::max(largest, influence);
        }
    }
    if (!(within > 0) || !(sum > 0)) return {};
    return {std::min(1.0, around / 2 / within), largest * within / sum};
}

std::array<double, most_parameters> parameter_units(const ShapeModel& model, double extent)
{
    std::array<double, most_parameters> units{};
    for (std::size_t j = 0; j < model.parameters; ++j) units[j] = std::pow(extent, model.dimension[j] - 1);
    return units;
}

}  // namespace pcm
