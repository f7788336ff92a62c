// Mixtures of noise and others against sampled and integrated ones.
#include "pcm/fit/noise_mixture.h"

#include "pcm/cloud/vector.h"
#include "tests/support.h"

#include <cmath>
#include <limits>
#include <vector>

namespace {

using namespace pcm;

constexpr double infinity = std::numeric_limits<double>::infinity();

double normal_density(double c) { return std::exp(-c * c / 2) / std::sqrt(2 * pi); }

// Root mean square of Gaussian distances of that deviation up to the threshold, by the midpoint rule.
double cut_rms(double deviation, double threshold)
{
    double sum = 0, squares = 0;
    const int steps = 200000;
    for (int i = 0; i < steps; ++i) {
        const double d = (i + 0.5) / steps * threshold, weight = normal_density(d / deviation);
        sum += weight;
        squares += weight * d * d;
    }
    return std::sqrt(squares / sum);
}

// As many points in each bin as the mixture has, where `total` are within the threshold.
DistanceBins expected_bins(double total, double share, double deviation, double threshold)
{
    DistanceBins bins;
    const double within = std::erf(threshold / deviation / std::sqrt(2.0));
    for (std::size_t i = 0; i < DistanceBins::size; ++i) {
        const auto below = [&](double part) {
            return std::erf(part * threshold / deviation / std::sqrt(2.0)) / within;
        };
        const double from = double(i) / DistanceBins::size, to = double(i + 1) / DistanceBins::size;
        bins.counts[i] = total * (share * (below(to) - below(from)) + (1 - share) * (to - from));
    }
    return bins;
}

TEST(NoiseMixture, TheDeviationOfACutIsThatOfTheNoise)
{
    for (const double threshold : {0.01, 1.0, 50.0})
        for (const double reach : {0.5, 1.0, 2.0, 3.0, 4.5}) {
            const double deviation = threshold / reach;
            EXPECT_NEAR(deviation_of_cut(cut_rms(deviation, threshold), threshold) / deviation, 1, 2e-3) << reach;
        }
    EXPECT_EQ(deviation_of_cut(0.19, 1), 0.19) << "nothing of it is cut off";
    EXPECT_EQ(deviation_of_cut(0.1, 1), 0.1);
    EXPECT_EQ(deviation_of_cut(7, infinity), 7);
    EXPECT_NEAR(deviation_of_cut(0.9, 1), 1 / 0.3, 1e-9) << "more than uniform distances have";
}

TEST(NoiseMixture, TheDensityAtTheCutIsThatOfCutNoise)
{
    for (const double threshold : {0.5, 2.0})
        for (const double reach : {0.5, 1.0, 3.0}) {
            const double deviation = threshold / reach, step = 1e-6 * threshold;
            const auto share = [&](double to) { return std::erf(to / deviation / std::sqrt(2.0)); };
            const double density = (share(threshold) - share(threshold - step)) / share(threshold) / step;
            EXPECT_NEAR(density_at_cut(deviation, threshold, 1000), 1000 * density * threshold, 1e-2);
        }
    EXPECT_EQ(density_at_cut(1, infinity, 1000), 0);
    EXPECT_EQ(density_at_cut(0, 1, 1000), 0);
}

TEST(NoiseMixture, LearnsTheDeviationFromTheBins)
{
    const double threshold = 2;
    for (const double share : {0.3, 0.6, 0.95})
        for (const double reach : {2.5, 4.0, 10.0, 30.0}) {
            NoiseMixture mixture(threshold, share);
            EXPECT_TRUE(mixture.all_belong());
            EXPECT_TRUE(mixture.needs_bins());
            const DistanceBins bins = expected_bins(5000, share, threshold / reach, threshold);
            EXPECT_TRUE(mixture.learn(bins, 1));
            EXPECT_FALSE(mixture.all_belong());
            EXPECT_NEAR(mixture.deviation() * reach / threshold, 1, reach > 20 ? 0.08 : 0.02) << share << ' ' << reach;
            const double deviation = mixture.deviation();
            EXPECT_FALSE(mixture.learn(bins, 1)) << "the same again";
            EXPECT_EQ(mixture.deviation(), deviation);
            EXPECT_TRUE(mixture.learn(expected_bins(5000, share, 1.3 * threshold / reach, threshold), 1));
            EXPECT_GT(mixture.deviation(), 1.1 * deviation);
        }
}

TEST(NoiseMixture, WeightsAreTheProbabilitiesAndCostsTheirIntegral)
{
    const double threshold = 2, share = 0.7, deviation = 0.4;
    const NoiseMixture mixture(threshold, share, deviation);
    ASSERT_FALSE(mixture.all_belong());
    EXPECT_EQ(mixture.threshold(), threshold);
    EXPECT_EQ(mixture.deviation(), deviation);
    const WeightTable table = mixture.table();
    ASSERT_EQ(table.size, 256);
    EXPECT_DOUBLE_EQ(table.step, threshold / 256);
    EXPECT_DOUBLE_EQ(table.per_length, 256 / threshold);
    const double within = std::erf(threshold / deviation / std::sqrt(2.0));
    const auto weight = [&](double d) {
        const double noise = share * 2 * normal_density(d / deviation) / deviation / within,
                     others = (1 - share) / threshold;
        const double x = d <= 0.9 * threshold ? 0 : std::min(1.0, (d / threshold - 0.9) / 0.1);
        return (1 - x * x) * (1 - x * x) * noise / (noise + others);
    };
    double cost = 0;
    for (int i = 0; i <= 256; ++i) {
        const double* row = table.rows + 3 * i;
        EXPECT_NEAR(row[0], weight(i * table.step), 1e-12) << i;
        EXPECT_NEAR(row[2], cost, 1e-12 + 1e-9 * cost) << i;
        if (i == 256) break;
        EXPECT_NEAR(row[1], (table.rows[3 * i + 3] - row[0]) / table.step, 1e-12) << i;
        // Twice the integral of weight times distance, of straight lines, exactly by Simpson's rule.
        const double from = i * table.step, to = from + table.step, middle = from + table.step / 2;
        const double at_end = row[0] + row[1] * table.step, at_middle = row[0] + row[1] * table.step / 2;
        cost += 2 * table.step / 6 * (from * row[0] + 4 * middle * at_middle + to * at_end);
    }
    EXPECT_EQ(table.rows[3 * 256], 0) << "nothing from the threshold on";
    EXPECT_GT(cost, 0.1 * deviation * deviation);
}

TEST(NoiseMixture, AllBelongWhereNothingTellsThemApart)
{
    const DistanceBins bins = expected_bins(5000, 0.7, 0.4, 2);
    NoiseMixture whole(2, 0.9995, 0.4), unlimited(infinity, 0.7, 0.4), known(2, 0.7, 0.4), wide(2, 0.7, 2 / 1.69);
    EXPECT_TRUE(whole.all_belong());
    EXPECT_FALSE(whole.needs_bins());
    EXPECT_FALSE(unlimited.needs_bins());
    EXPECT_FALSE(known.all_belong());
    EXPECT_TRUE(wide.all_belong());
    EXPECT_FALSE(NoiseMixture(2, 0.7, 2 / 1.71).all_belong());
    EXPECT_FALSE(whole.learn(bins, 0.3)) << "they all belonged before";
    EXPECT_NEAR(whole.deviation(), deviation_of_cut(0.3, 1.9), 1e-12);
    // Few points: what was known is given up, once.
    const DistanceBins few = expected_bins(59, 0.7, 0.4, 2), enough = expected_bins(61, 0.7, 0.4, 2);
    EXPECT_FALSE(known.learn(enough, 0.3));
    EXPECT_FALSE(known.all_belong());
    EXPECT_TRUE(known.learn(few, 0.3));
    EXPECT_TRUE(known.all_belong());
    EXPECT_FALSE(known.learn(few, 0.3));
    // As uniform as others are.
    NoiseMixture uniform(2, 0.7, 0.4);
    DistanceBins even;
    even.counts.fill(100);
    EXPECT_TRUE(uniform.learn(even, 0.3));
    EXPECT_TRUE(uniform.all_belong());
}

}  // namespace
