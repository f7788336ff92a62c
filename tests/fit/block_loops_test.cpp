// The loops of all vector levels against each other, to the bit, and against sums in plain order. Blocks end anywhere;
// what lies behind their last point must not matter.
#include "pcm/fit/block_loops.h"

#include "pcm/shapes/shape.h"
#include "pcm/system/cpu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <random>

namespace pcm {
namespace {

const BlockLoops& loops_of(SimdLevel level)
{
    if (level == SimdLevel::avx512) return avx512_block_loops();
    return level == SimdLevel::avx2 ? avx2_block_loops() : baseline_block_loops();
}

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double threshold = 0.1;
const std::size_t counts[] = {1, 2, 7, 8, 9, 15, 31, 100, 248, 255, 256};

struct Columns {
    double x[patch_block], y[patch_block], z[patch_block];
};

Columns columns(std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    Columns points;
    for (std::size_t i = 0; i < patch_block; ++i)
        points.x[i] = anywhere(random), points.y[i] = anywhere(random), points.z[i] = anywhere(random);
    return points;
}

// Distances within the threshold, equal to it, above it and far above it.
PatchBlock block_of(std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    PatchBlock block;
    for (std::size_t i = 0; i < patch_block; ++i) {
        const double places[] = {0.5, 1, -1, 2, 4, 50, -0.9, 0};
        block.distance[i] = threshold * (i % 3 == 0 ? places[i / 3 % 8] : 1.5 * anywhere(random));
        for (auto& by : block.by) by[i] = anywhere(random);
        if (i < count) continue;
        block.distance[i] = nothing;
        for (auto& by : block.by) by[i] = nothing;
    }
    return block;
}

struct Weighed {
    PatchBlock block;
    BlockWeights weights;
    double near = 0;
};

Weighed weighed(const BlockLoops& loops, std::size_t count, std::uint64_t seed)
{
    Weighed result{block_of(count, seed), {}, 0};
    for (double* column : {result.weights.within, result.weights.weight, result.weights.slope, result.weights.cost})
        std::fill(column, column + patch_block, nothing);
    result.near = loops.within(result.block, count, threshold, result.weights);
    return result;
}

::testing::AssertionResult same_bits(const double* a, const double* b, std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i)
        if (std::memcmp(a + i, b + i, sizeof *a) != 0)
            return ::testing::AssertionFailure() << "number " << i << ": " << a[i] << " and " << b[i];
    return ::testing::AssertionSuccess();
}

::testing::AssertionResult same_bits(const BlockWeights& a, const BlockWeights& b, std::size_t count)
{
    for (const auto column : {&BlockWeights::within, &BlockWeights::weight, &BlockWeights::slope, &BlockWeights::cost})
        if (const auto result = same_bits(a.*column, b.*column, count); !result) return result;
    return ::testing::AssertionSuccess();
}

// All levels write the same numbers, and nothing behind the last one.
template <class Loop>
void compare_columns(const Loop& loop)
{
    for (const std::size_t count : counts) {
        const Columns points = columns(count);
        double first[patch_block], out[patch_block];
        for (const SimdLevel level : simd_levels()) {
            std::fill(out, out + patch_block, -7.0);
            loop(loops_of(level), points, count, out);
            for (std::size_t i = count; i < patch_block; ++i) ASSERT_EQ(out[i], -7.0) << count;
            if (level == SimdLevel::baseline) std::copy(out, out + patch_block, first);
            EXPECT_TRUE(same_bits(first, out, count)) << name_of(level) << ' ' << count;
        }
    }
}

TEST(BlockLoops, DistancesAreTheSameOnAllLevels)
{
    const ShapeNumbers shape{{0.1, 0.2, -0.3}, {0.6, 0, 0.8}, 0.4, 0};
    for (const auto of : {&BlockLoops::plane, &BlockLoops::cylinder, &BlockLoops::sphere})
        compare_columns([&](const BlockLoops& loops, const Columns& p, std::size_t count, double* out) {
            (loops.*of).distances(shape, p.x, p.y, p.z, count, out);
        });
}

TEST(BlockLoops, DerivativesAreTheSameOnAllLevels)
{
    // The curvature of the second is above that of any point, whose roots have nothing under them.
    for (const double curvature : {0.7, -9.0, 0.0}) {
        const PatchNumbers patch{{0.1, 0.2, -0.3}, {0, 0.6, 0.8}, {1, 0, 0}, {0, 0.8, -0.6}, curvature};
        for (const auto of : {&BlockLoops::plane, &BlockLoops::cylinder, &BlockLoops::sphere})
            for (std::size_t j = 0; j <= 3; ++j)
                compare_columns([&](const BlockLoops& loops, const Columns& p, std::size_t count, double* out) {
                    PatchBlock block;
                    std::fill(block.by[3], block.by[3] + patch_block, 0.0);
                    (loops.*of).differentiate(patch, p.x, p.y, p.z, count, block);
                    const double* from = j == 0 ? block.distance : block.by[j];
                    std::copy(from, from + count, out);
                    for (std::size_t i = 0; i < count; ++i) ASSERT_TRUE(std::isfinite(out[i]));
                });
    }
}

TEST(BlockLoops, DerivativesAtAnAxisAreFinite)
{
    const PatchNumbers patch{{0.1, 0.2, -0.3}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, -2};
    const double x[] = {0.1 + 0.5}, y[] = {0.2}, z[] = {-0.3};
    for (const SimdLevel level : simd_levels())
        for (const auto of : {&BlockLoops::cylinder, &BlockLoops::sphere}) {
            PatchBlock block;
            std::fill(block.by[4], block.by[4] + 1, 0.0);
            (loops_of(level).*of).differentiate(patch, x, y, z, 1, block);
            EXPECT_NEAR(block.distance[0], 0.5, 1e-12);
            for (std::size_t j = 0; j < 5; ++j) EXPECT_TRUE(std::isfinite(block.by[j][0])) << j;
        }
}

TEST(BlockLoops, SumsOfColumns)
{
    for (const std::size_t count : counts) {
        const Columns points = columns(7 + count);
        const double *x = points.x, *y = points.y;
        double largest = 0, sum = 0, product = 0;
        for (std::size_t i = 0; i < count; ++i) {
            largest = std::max(largest, std::fabs(x[i] - 0.3));
            sum += 5 * x[i];
            product += 5 * (x[i] - 0.3) * (5 * (y[i] + 0.2));
        }
        double first[2] = {};
        for (const SimdLevel level : simd_levels()) {
            const BlockLoops& loops = loops_of(level);
            EXPECT_EQ(loops.largest(x, count, 0.3), largest) << name_of(level) << ' ' << count;
            const double found[2] = {loops.sum_scaled(x, count, 5), loops.sum_products(x, y, count, 0.3, -0.2, 5)};
            EXPECT_NEAR(found[0], sum, 1e-12) << name_of(level) << ' ' << count;
            EXPECT_NEAR(found[1], product, 1e-11) << name_of(level) << ' ' << count;
            if (level == SimdLevel::baseline) std::copy(found, found + 2, first);
            EXPECT_TRUE(same_bits(first, found, 2)) << name_of(level) << ' ' << count;
        }
    }
    // The largest may be anywhere, and be below 0; what is not finite shows wherever it is.
    for (const SimdLevel level : simd_levels())
        for (std::size_t at = 0; at < 11; ++at) {
            double values[11] = {};
            values[at] = -3;
            EXPECT_EQ(loops_of(level).largest(values, 11, 0), 3);
            for (const double bad : {nothing, std::numeric_limits<double>::infinity()}) {
                values[at] = bad;
                EXPECT_FALSE(loops_of(level).sum_scaled(values, 11, 0) == 0) << at;
            }
        }
}

TEST(BlockLoops, ScoresAreSumsOfSquares)
{
    for (const std::size_t count : counts) {
        const PatchBlock block = block_of(count, 3);
        const double limit = threshold * threshold;
        double squares = 0, near = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double square = block.distance[i] * block.distance[i];
            squares += std::min(square, limit);
            near += square <= limit;
        }
        double first = 0;
        for (const SimdLevel level : simd_levels()) {
            double sum = 0, counted = 0;
            loops_of(level).score(block.distance, count, limit, &sum, &counted);
            EXPECT_NEAR(sum, squares, 1e-14 * squares) << name_of(level) << ' ' << count;
            EXPECT_EQ(counted, near) << name_of(level) << ' ' << count;
            if (level == SimdLevel::baseline) first = sum;
            EXPECT_EQ(sum, first) << name_of(level) << ' ' << count;
        }
    }
}

TEST(BlockLoops, WeightsAreTheSameOnAllLevels)
{
    double rows[3 * 17], support[patch_block];
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> anywhere(0, 1);
    for (double& number : rows) number = anywhere(random);
    for (double& one : support) one = anywhere(random) < 0.5;
    const WeightTable table{rows, 16, threshold / 16, 16 / threshold};
    for (const std::size_t count : counts)
        for (const double* part : {static_cast<const double*>(nullptr), static_cast<const double*>(support)})
            for (int way = 0; way < 3; ++way) {
                BlockWeights first{};
                for (const SimdLevel level : simd_levels()) {
                    const BlockLoops& loops = loops_of(level);
                    Weighed one = weighed(loops, count, 2 + way);
                    if (way == 0) loops.weigh_alike(one.block, count, 3, one.weights);
                    if (way == 1) loops.weigh_tapered(one.block, count, 0.08, threshold, part, one.weights);
                    if (way == 2) loops.weigh(one.block, count, table, part, one.weights);
                    if (level == SimdLevel::baseline) first = one.weights;
                    EXPECT_TRUE(same_bits(first, one.weights, count)) << name_of(level) << ' ' << count << ' ' << way;
                    for (std::size_t i = count; i < patch_block; ++i)
                        ASSERT_TRUE(std::isnan(one.weights.weight[i])) << count;
                    double near = 0;
                    for (std::size_t i = 0; i < count; ++i) near += std::fabs(one.block.distance[i]) <= threshold;
                    EXPECT_EQ(one.near, near);
                }
            }
}

TEST(BlockLoops, TaperedWeightsAreWhatTheyClaim)
{
    constexpr double from = 0.09, width = threshold - from, small = 1e-7;
    const BlockLoops& loops = baseline_block_loops();
    PatchBlock block{};
    BlockWeights at, before, after;
    const auto weigh = [&](double by, BlockWeights& weights) {
        for (std::size_t i = 0; i < patch_block; ++i)
            block.distance[i] = (i % 2 == 0 ? 1 : -1) * (0.12 * static_cast<double>(i) / patch_block + by);
        loops.within(block, patch_block, threshold, weights);
        loops.weigh_tapered(block, patch_block, from, threshold, nullptr, weights);
    };
    weigh(-small, before);
    weigh(small, after);
    weigh(0, at);
    for (std::size_t i = 1; i < patch_block; ++i) {
        const double away = std::fabs(block.distance[i]), u = std::clamp((away - from) / width, 0.0, 1.0);
        ASSERT_NEAR(at.weight[i], (1 - u * u) * (1 - u * u), 1e-12) << away;
        // Derivatives of the cost, and of weight times distance.
        ASSERT_NEAR(at.weight[i] * away, (after.cost[i] - before.cost[i]) / (4 * small), 1e-8) << away;
        ASSERT_NEAR(at.slope[i], (after.weight[i] * (away + small) - before.weight[i] * (away - small)) / (2 * small),
                    1e-3)
            << away;
        if (away <= from) ASSERT_NEAR(at.cost[i], away * away, 1e-15);
        if (away > threshold) ASSERT_EQ(at.cost[i], at.cost[patch_block - 1]);
    }
    // Costs have no step at the threshold, and are finite however far a point is.
    block.distance[0] = threshold * (1 - 1e-9);
    block.distance[1] = 1e200;
    loops.within(block, 2, threshold, at);
    loops.weigh_tapered(block, 2, from, threshold, nullptr, at);
    EXPECT_NEAR(at.cost[0], at.cost[1], 1e-15);
    EXPECT_EQ(at.weight[1], 0);
}

TEST(BlockLoops, WeightsOfATableAreStraightLines)
{
    constexpr std::int32_t size = 8;
    constexpr double step = threshold / size;
    double rows[3 * (size + 1)];
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> anywhere(0.1, 1);
    for (double& number : rows) number = anywhere(random);
    const PatchBlock block = block_of(patch_block, 11);
    BlockWeights found;
    baseline_block_loops().within(block, patch_block, threshold, found);
    baseline_block_loops().weigh(block, patch_block, {rows, size, step, 1 / step}, nullptr, found);
    for (std::size_t i = 0; i < patch_block; ++i) {
        const double away = std::fabs(block.distance[i]);
        if (away > threshold) {
            EXPECT_EQ(found.weight[i], 0);
            EXPECT_EQ(found.cost[i], rows[3 * size + 2]);
            continue;
        }
        const auto k = static_cast<std::size_t>(away / step);
        const double from = static_cast<double>(k) * step, weight = rows[3 * k], grows = rows[3 * k + 1];
        // Twice the integral of weight times distance, of third degree: Simpson's rule is exact.
        const auto term = [&](double t) { return 2 * t * (weight + grows * (t - from)); };
        const double cost = (away - from) / 6 * (term(from) + 4 * term((from + away) / 2) + term(away));
        EXPECT_NEAR(found.weight[i], weight + grows * (away - from), 1e-14);
        EXPECT_NEAR(found.slope[i], weight + grows * (away - from) + away * grows, 1e-14);
        EXPECT_NEAR(found.cost[i], rows[3 * k + 2] + cost, 1e-15);
    }
}

TEST(BlockLoops, BinsDivideTheThreshold)
{
    for (const SimdLevel level : simd_levels()) {
        PatchBlock block{};
        const double places[] = {0, 0.249, -0.2501, 0.7499, 0.7501, -0.999, 1.001, 100};
        std::copy(std::begin(places), std::end(places), block.distance);
        std::int32_t bins[9] = {0, 0, 0, 0, 0, 0, 0, 0, -7};
        loops_of(level).find_bins(block, 8, 1, 4, bins);
        const std::int32_t expected[9] = {0, 0, 1, 2, 3, 3, 4, 4, -7};
        for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(bins[i], expected[i]) << name_of(level) << ' ' << i;
    }
}

TEST(BlockLoops, SumsAreThoseOfAllPoints)
{
    for (const std::size_t count : counts)
        for (std::size_t parameters = 3; parameters <= most_parameters; ++parameters) {
            BlockSums first{};
            for (const SimdLevel level : simd_levels()) {
                const BlockLoops& loops = loops_of(level);
                Weighed one = weighed(loops, count, parameters);
                loops.weigh_tapered(one.block, count, 0.08, threshold, nullptr, one.weights);
                BlockSums sums{};
                std::fill(std::begin(sums.gradient), std::end(sums.gradient), -7);
                std::fill(std::begin(sums.products), std::end(sums.products), -7);
                loops.sum(one.block, one.weights, count, parameters, sums);
                EXPECT_EQ(std::count(std::begin(sums.gradient), std::end(sums.gradient), -7),
                          most_parameters - parameters)
                    << "no sums of what was not computed";
                if (level == SimdLevel::baseline) first = sums;
                const auto expect = [&](double found, double BlockSums::*of, const auto& term) {
                    double sum = 0, size = 0;
                    for (std::size_t i = 0; i < count; ++i) {
                        const double added = term(i, one.weights.weight[i], one.block.distance[i]);
                        sum += added;
                        size += std::fabs(added);
                    }
                    EXPECT_NEAR(found, sum, 1e-14 * size + 1e-300) << name_of(level) << ' ' << count;
                    if (of) EXPECT_EQ(found, first.*of) << name_of(level) << ' ' << count;
                };
                expect(sums.used, &BlockSums::used, [](std::size_t, double w, double) { return w; });
                expect(sums.slope, &BlockSums::slope,
                       [&](std::size_t i, double, double) { return one.weights.slope[i]; });
                expect(sums.squares, &BlockSums::squares, [](std::size_t, double w, double d) { return w * d * d; });
                expect(sums.pull, &BlockSums::pull, [](std::size_t, double w, double d) { return w * d * w * d; });
                expect(loops.cost(one.weights, count), nullptr,
                       [&](std::size_t i, double, double) { return one.weights.cost[i]; });
                expect(loops.squares(one.block, one.weights, count), nullptr,
                       [&](std::size_t i, double, double d) { return one.weights.within[i] * d * d; });
                for (std::size_t j = 0; j < parameters; ++j) {
                    const double* by = one.block.by[j];
                    expect(sums.gradient[j], nullptr, [&](std::size_t i, double w, double d) { return w * d * by[i]; });
                    EXPECT_EQ(sums.gradient[j], first.gradient[j]) << name_of(level);
                    for (std::size_t k = j; k < parameters; ++k) {
                        const std::size_t at = j * most_parameters + k;
                        expect(sums.products[at], nullptr,
                               [&](std::size_t i, double w, double) { return w * by[i] * one.block.by[k][i]; });
                        EXPECT_EQ(sums.products[at], first.products[at]) << name_of(level);
                    }
                }
            }
        }
}

TEST(BlockLoops, FactsAreThoseOfAllPoints)
{
    double inverse[25];
    for (std::size_t j = 0; j < 5; ++j)
        for (std::size_t k = 0; k < 5; ++k) inverse[5 * j + k] = j == k ? 2 : 0.1 * static_cast<double>(j + k);
    for (const std::size_t count : counts) {
        BlockFacts first{};
        for (const SimdLevel level : simd_levels()) {
            const PatchBlock block = block_of(count, 9);
            BlockFacts facts{3, 4, 5, 6}, expected = facts;
            loops_of(level).facts(block, count, 5, inverse, threshold, facts);
            for (std::size_t i = 0; i < count; ++i) {
                const double away = std::fabs(block.distance[i]);
                if (away > 2 * threshold && away <= 4 * threshold) expected.around += 1;
                if (away > threshold) continue;
                double influence = 0;
                for (std::size_t j = 0; j < 5; ++j)
                    for (std::size_t k = 0; k < 5; ++k)
                        influence += inverse[5 * j + k] * block.by[j][i] * block.by[k][i];
                expected.within += 1;
                expected.sum += influence;
                expected.largest = std::max(expected.largest, influence);
            }
            EXPECT_EQ(facts.within, expected.within);
            EXPECT_EQ(facts.around, expected.around);
            EXPECT_NEAR(facts.sum, expected.sum, 1e-13 * expected.sum);
            EXPECT_NEAR(facts.largest, expected.largest, 1e-14 * expected.largest);
            if (level == SimdLevel::baseline) first = facts;
            EXPECT_EQ(facts.sum, first.sum) << name_of(level);
            EXPECT_EQ(facts.largest, first.largest) << name_of(level);
        }
    }
}

}  // namespace
}  // namespace pcm
