#include "pcm/filter/value_statistics.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

namespace {

using namespace pcm;

using Values = std::vector<double>;

// Gives the values in runs of some length.
auto given(const Values& values, std::size_t run = 1000)
{
    return [&values, run](const std::function<void(const double*, std::size_t)>& see) {
        for (std::size_t at = 0; at < values.size(); at += run)
            see(values.data() + at, std::min(run, values.size() - at));
    };
}

const auto same = [](double v) { return v; };

Values drawn(std::size_t count, std::uint64_t seed, const std::function<double(double)>& f)
{
    std::mt19937_64 random(seed);
    Values values(count);
    for (double& v : values) v = f(static_cast<double>(random() >> 11) * 0x1p-53);
    return values;
}

TEST(ValueStatistics, PCM_NOT_UNDER_THREAD(RanksAreThoseOfSortedNumbers))
{
    const std::function<double(double)> distributions[] = {
        [](double u) { return u; },
        [](double u) { return std::floor(10 * u); },
        [](double) { return 4.25; },
        [](double u) { return u < 0.4 ? 0.0 : u; },
        [](double u) { return std::exp(1400 * (u - 0.5)); },
        [](double u) { return 1 + 1e-13 * std::floor(1000 * u); },  // differ in their last bits alone
        [](double u) { return u < 1e-4 ? 1e300 : 5e-324 * std::floor(3 * u); },
    };
    for (const auto& f : distributions)
        for (const std::size_t count : {1, 2, 7, 1000, 200000}) {
            const Values values = drawn(count, 3, f);
            Values sorted = values;
            std::sort(sorted.begin(), sorted.end());
            for (const std::size_t rank : {std::size_t(0), count / 3, count / 2, count - 1})
                ASSERT_EQ(value_of_rank(given(values), rank, same), sorted[rank]) << count << " " << rank;
        }
}

TEST(ValueStatistics, MediansOfOddAndEvenCountsAndOfFunctions)
{
    EXPECT_EQ(median_of(given({3}), 1, same), 3);
    EXPECT_EQ(median_of(given({3, 8}), 2, same), 5.5);
    EXPECT_EQ(median_of(given({3, 8, 4}), 3, same), 4);
    EXPECT_EQ(median_of(given({9, 3, 8, 4}), 4, same), 6);
    const Values values{1, 1, 2, 2, 4, 6, 9};
    EXPECT_EQ(median_of(given(values, 2), 7, [](double v) { return std::fabs(v - 2); }), 1);
    EXPECT_EQ(median_of(given({std::numeric_limits<double>::max(), std::numeric_limits<double>::max()}), 2, same),
              std::numeric_limits<double>::max());
}

TEST(ValueStatistics, MeanAndDeviationLoseNoBits)
{
    EXPECT_EQ(mean_and_deviation(given({})).mean, 0);
    for (const double v : {0.1, 1e-9, 1e9 / 3}) {
        const MeanAndDeviation equal = mean_and_deviation(given(Values(100003, v)));
        EXPECT_EQ(equal.mean, v);
        EXPECT_EQ(equal.deviation, 0);
    }
    for (const double shift : {0.0, 1.0, 1e6, 1e12}) {
        const Values values = drawn(100000, 5, [&](double u) { return shift + u; });
        long double sum = 0, squares = 0;
        for (const double v : values) sum += v;
        const long double mean = sum / 100000;
        for (const double v : values) squares += (v - mean) * (v - mean);
        const MeanAndDeviation all = mean_and_deviation(given(values));
        EXPECT_NEAR(all.mean, double(mean), 1e-15 * double(mean));
        EXPECT_NEAR(all.deviation, double(std::sqrt(squares / 100000)), 1e-11);
    }
    // One far value does not take the last bits of the others.
    Values far = drawn(100000, 6, [](double u) { return u; });
    far.push_back(1e16);
    long double sum = 0;
    for (const double v : far) sum += v;
    EXPECT_NEAR(mean_and_deviation(given(far)).mean, double(sum / 100001), 2e-5);
    CompensatedSum cancelled;
    for (const double v : {1e16, 3.25, -1e16}) cancelled.add(v);
    EXPECT_EQ(cancelled.value(), 3.25);
}

}  // namespace
