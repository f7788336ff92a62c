#include "pcm/cache/load_times.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace pcm;

TEST(LoadTimes, BucketsArePowersOfTwoOfAMicrosecond)
{
    for (std::size_t b = 0; b < 24; ++b) {
        LoadTimes times;
        times.add(std::ldexp(1.0, static_cast<int>(b)) * 1e-6 * 1.0001);
        times.add(std::ldexp(1.0, static_cast<int>(b) + 1) * 1e-6 * 0.9999);
        EXPECT_EQ(times.buckets[b], 2u) << b;
        EXPECT_EQ(times.count(), 2u);
    }
    LoadTimes times;
    for (const double shorter : {0.0, 1e-9, -1.0, 1.99e-6, std::nan("")}) times.add(shorter);
    EXPECT_EQ(times.buckets[0], 5u);
    for (const double longer : {17.0, 1e9, 1e300, std::numeric_limits<double>::infinity()}) times.add(longer);
    EXPECT_EQ(times.buckets[23], 4u);
    EXPECT_EQ(times.count(), 9u);
}

TEST(LoadTimes, QuantilesAreRightToAFactorOfTwo)
{
    EXPECT_EQ(LoadTimes().quantile(0.5), 0.0);
    std::mt19937_64 random(3);
    std::vector<double> all;
    LoadTimes times, half;
    for (int i = 0; i < 10000; ++i) {
        const double seconds = std::exp(std::uniform_real_distribution<double>(std::log(2e-6), std::log(1.0))(random));
        all.push_back(seconds);
        (i % 2 ? times : half).add(seconds);
    }
    times += half;
    std::sort(all.begin(), all.end());
    double last = 0;
    for (const double q : {0.01, 0.1, 0.5, 0.9, 0.99, 1.0}) {
        const double exact = all[static_cast<std::size_t>(q * 9999)];
        EXPECT_GT(times.quantile(q), exact / 2) << q;
        EXPECT_LT(times.quantile(q), exact * 2) << q;
        EXPECT_GE(times.quantile(q), last);
        last = times.quantile(q);
    }
    EXPECT_EQ(times.quantile(2), times.quantile(1));
    EXPECT_LE(times.quantile(-1), all.front());
}
