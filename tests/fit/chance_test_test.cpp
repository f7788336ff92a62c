// The chance test against exact binomial tails and shares that are known.
#include "pcm/fit/chance_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pcm {
namespace {

// Natural logarithm of the probability that at least `least` of n points lie where each is with this probability.
double log_tail(std::size_t n, std::size_t least, double probability)
{
    double largest = -HUGE_VAL;
    std::vector<double> terms;
    for (std::size_t k = least; k <= n; ++k) {
        const double ways = std::lgamma(double(n) + 1) - std::lgamma(double(k) + 1) - std::lgamma(double(n - k) + 1);
        terms.push_back(ways + double(k) * std::log(probability) + double(n - k) * std::log1p(-probability));
        largest = std::max(largest, terms.back());
    }
    double sum = 0;
    for (const double term : terms) sum += std::exp(term - largest);
    return largest + std::log(sum);
}

WorkingPoints points_in(const Vec3d& size, std::size_t count, std::uint64_t seed = 1)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    WorkingPoints points;
    for (std::size_t i = 0; i < count; ++i) {
        // Two corners of the box, so that it is as large as was asked.
        const double corner = i == 0 ? -0.5 : 0.5;
        points.x.push_back(size[0] * (i < 2 ? corner : uniform(random)));
        points.y.push_back(size[1] * (i < 2 ? corner : uniform(random)));
        points.z.push_back(size[2] * (i < 2 ? corner : uniform(random)));
        points.index.push_back(static_cast<std::uint32_t>(i));
    }
    return points;
}

const Shape flat{ShapeKind::plane, {0, 0, 0}, {0, 0, 1}, 0, 0};

// Chernoff's bound is never below the tail, and at most some powers of n above it. The number of shapes is the inverse
// of the share, a tenth at most, to 0.8 of the number of parameters.
TEST(ChanceBounds, BoundsTheBinomialTail)
{
    for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::sphere, ShapeKind::cylinder}) {
        const ShapeModel& model = model_of(kind);
        const auto free = double(model.parameters());
        std::size_t below = 0, none = 0;
        for (const std::size_t size : {30u, 200u, 1000u}) {
            const WorkingPoints points = points_in({1, 1, 1}, size);
            const ChanceTest test(points);
            const std::size_t n = size - model.parameters();
            for (const double share : {0.01, 0.08, 0.3, 0.5, 0.9})
                for (std::size_t near = 1; near <= n; near += 1 + n / 37) {
                    const double alarms = test.log_alarms(model, share, double(near) + free);
                    ASSERT_LE(alarms, 0);
                    const double shapes = 0.8 * free * std::log(1 / std::min(share, 0.1));
                    if (double(near) <= share * double(n)) {
                        ASSERT_EQ(alarms, 0) << share << ", " << near << " of " << n;
                        ++none;
                        continue;
                    }
                    const double exact = shapes + log_tail(n, near, share);
                    ASSERT_GE(alarms, std::min(0.0, exact) - 1e-9 * double(n));
                    ASSERT_LE(alarms, std::min(0.0, exact + std::log(double(n)) + 1));
                    below += alarms < 0;
                }
        }
        EXPECT_GT(below, 150u);
        EXPECT_GT(none, 100u);
    }
}

TEST(ChanceBounds, NeedsMorePointsThanParameters)
{
    const ShapeModel& model = model_of(ShapeKind::plane);
    const WorkingPoints few = points_in({1, 1, 1}, model.parameters()), more = points_in({1, 1, 1}, 100);
    EXPECT_EQ(ChanceTest(few).log_alarms(model, 1e-6, double(few.size())), 0);
    EXPECT_EQ(ChanceTest(more).log_alarms(model, 1e-6, double(model.parameters())), 0);
    EXPECT_LT(ChanceTest(more).log_alarms(model, 1e-6, double(model.parameters()) + 8), 0);
    // All of them: the tail is the share to the power of their number.
    const double all = ChanceTest(more).log_alarms(model, 0.01, 100), free = double(model.parameters());
    EXPECT_NEAR(all, 0.8 * free * std::log(100) + (100 - free) * std::log(0.01), 1e-9);
}

TEST(ChanceBounds, SharesAreThoseOfTheBox)
{
    const ShapeModel& model = model_of(ShapeKind::plane);
    const WorkingPoints in_cube = points_in({2, 2, 2}, 50);
    const ChanceTest cube(in_cube);
    for (const double threshold : {0.05, 0.1, 0.3, 0.7})
        EXPECT_NEAR(cube.share(model, flat, threshold), threshold, 0.004);
    EXPECT_EQ(cube.share(model, flat, 1.01), 1);
    // Thresholds that few places are within have shares in proportion.
    for (const double threshold : {1e-3, 1e-5, 1e-9})
        EXPECT_NEAR(cube.share(model, flat, threshold) / threshold, 1, 0.05) << threshold;
    // A flat box counts as a tenth as thick as it is wide.
    const WorkingPoints thin = points_in({2, 1, 1e-6}, 50);
    const ChanceTest slab(thin);
    EXPECT_NEAR(slab.share(model, flat, 0.05), 0.5, 0.01);
    // A shape that is moved out of the middle, in a box that is too.
    WorkingPoints points = points_in({2, 2, 2}, 50);
    for (double& z : points.z) z += 7;
    const ChanceTest high(points);
    Shape moved = flat;
    moved.point = {0, 0, 6};  // the box's lower side
    EXPECT_NEAR(high.share(model, moved, 0.2), 0.1, 0.004);
    EXPECT_EQ(high.share(model, moved, 2.01), 1);
}

// A band of points, thin or thick, among others: the threshold is the band's, from wherever the search begins.
TEST(ChanceBounds, TheBestThresholdIsTheBandsOwn)
{
    const ShapeModel& model = model_of(ShapeKind::plane);
    for (const double half : {0.02, 0.05, 0.1})
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            WorkingPoints points = points_in({2, 2, 2}, 900, seed);
            for (std::size_t i = 2; i < 300; ++i) points.z[i] *= half;
            const ChanceTest test(points);
            for (const double most : {0.4, 0.9}) {
                const double best = test.best_threshold(model, flat, most);
                EXPECT_LE(best, most);
                EXPECT_GT(best, half / 1.3) << half << ", seed " << seed;
                EXPECT_LT(best, half * 1.3) << half << ", seed " << seed;
            }
        }
    // Where all is by chance, any threshold is as good as the first.
    const WorkingPoints anywhere = points_in({2, 2, 2}, 100);
    const ChanceTest chance(anywhere);
    EXPECT_EQ(chance.best_threshold(model, flat, 0.4), 0.4);
}

}  // namespace
}  // namespace pcm
