#include "pcm/fit/patch_sums.h"

#include <algorithm>
#include <cmath>

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

void take_away_other_normals(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points,
                             double least_cosine, std::size_t first, std::size_t count, double* weight)
{
    const Shape shape = model.shape_of(patch);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d normal = points.normal(first + i);
        if (weight[i] > 0 && dot(normal, normal) > 0 &&
            std::fabs(dot(normal, normal_at(shape, points.at(first + i)))) < least_cosine)
            weight[i] = 0;
    }
}

struct BlockSums {
    alignas(64) double weight[patch_block];
    alignas(64) double weighted[patch_block];
    alignas(64) double squares[patch_block];

    void add(PatchSums& sums, PatchBlock& block, std::size_t count)
    {
        const double* distance = block.distance;
        for (std::size_t i = 0; i < count; ++i) weighted[i] = weight[i] * distance[i];
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
                  const PatchBand& band, const NoiseMixture& mixture, DistanceBins* bins)
{
    PatchSums sums;
    sums.parameters = model.parameters;
    const std::size_t n = std::min(points.size(), band.points);
    const double bin = static_cast<double>(DistanceBins::size) / band.threshold;
    PatchBlock block;
    BlockSums block_sums;
    for (std::size_t first = 0; first < n; first += patch_block) {
        const std::size_t count = std::min(patch_block, n - first);
        model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
        double* weight = block_sums.weight;
        for (std::size_t i = 0; i < count; ++i) weight[i] = std::fabs(block.distance[i]) <= band.threshold ? 1 : 0;
        if (band.least_cosine > 0 && points.has_normals())
            take_away_other_normals(model, patch, points, band.least_cosine, first, count, weight);
        std::size_t near = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (!(weight[i] > 0)) continue;
            ++near;
            const double away = std::fabs(block.distance[i]), part = band.support ? band.support[first + i] : 1;
            if (bins) bins->counts[std::min(DistanceBins::size - 1, static_cast<std::size_t>(away * bin))] += part;
            const NoiseMixture::Weight by = mixture.weight(away);
            sums.cost += part * by.cost + (1 - part) * mixture.cost_beyond();
            weight[i] = part * by.weight;
            sums.used += weight[i];
            sums.slope += part * by.slope;
        }
        sums.inliers += near;
        sums.cost += static_cast<double>(count - near) * mixture.cost_beyond();
        if (near > 0) block_sums.add(sums, block, count);
    }
    return sums;
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
