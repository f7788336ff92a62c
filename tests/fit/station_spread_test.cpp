// The spread of stations and their shifts from differences that are made by hand.
#include "pcm/fit/station_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace {

using namespace pcm;

// A surface that shows the shift of each axis of each station apart: H is diagonal.
struct Diagonal {
    std::vector<double> weights, pulls;  // three a station
    void add_to(StationEvidence& evidence, double noise = 1, std::uint32_t first = 0) const
    {
        std::vector<std::uint32_t> stations(weights.size() / 3);
        std::iota(stations.begin(), stations.end(), first);
        std::vector<double> h(weights.size() * weights.size(), 0.0);
        for (std::size_t k = 0; k < weights.size(); ++k) h[k * weights.size() + k] = weights[k];
        evidence.add(stations, h, pulls, noise);
    }
    StationEvidence evidence(double noise = 1) const
    {
        StationEvidence evidence;
        add_to(evidence, noise);
        return evidence;
    }
    // Twice the negative logarithm of the likelihood of the spread.
    double cost(double spread, double alike = 1) const
    {
        double cost = 0;
        for (std::size_t k = 0; k < weights.size(); ++k) {
            const double variance = spread * spread + alike * alike / weights[k];
            cost += std::log(variance) + std::pow(pulls[k] / weights[k], 2) / variance;
        }
        return cost;
    }
    double least_cost(double alike = 1) const
    {
        double least = cost(0, alike);
        for (double spread = 1e-6; spread < 1e4; spread *= 1.0005) least = std::min(least, cost(spread, alike));
        return least;
    }
};

// Differences of 1, -2, 3 and so on, each times its weight.
Diagonal some_differences(double scale = 1)
{
    Diagonal some{{100, 40, 9, 30, 25, 16}, {}};
    double difference = scale;
    for (const double weight : some.weights) {
        some.pulls.push_back(weight * difference);
        difference = -difference - (difference > 0 ? scale : -scale);
    }
    return some;
}

TEST(StationEvidence, TheSpreadIsTheMostProbableOfAll)
{
    for (const double scale : {1e-3, 0.1, 0.3, 1.0, 50.0})
        for (const double alike : {1.0, 3.0}) {
            const Diagonal some = some_differences(scale);
            const StationSpread found = some.evidence().spread(alike);
            EXPECT_LE(some.cost(found.spread, alike), some.least_cost(alike) + 1e-6) << scale << " " << alike;
            EXPECT_EQ(found.stations, 2u);
        }
    // The likelihood has two peaks: small differences are exact, large ones are not.
    for (const double large : {2.5, 4.0}) {
        const Diagonal two{{1000, 1000, 1000, 1.1, 1.1, 1.1}, {50, -50, 50, 1.1 * large, 1.1 * large, -1.1 * large}};
        const double found = two.evidence().spread().spread;
        EXPECT_LE(two.cost(found), two.least_cost() + 1e-6);
        EXPECT_EQ(found > 1, large == 4) << found;
    }
}

TEST(StationEvidence, WhereNoiseExplainsTheDifferencesThereIsNoSpread)
{
    const Diagonal noise{{100, 100, 100}, {5, -3, 8}};  // 0.05, -0.03 and 0.08 where 0.1 is a deviation
    const StationSpread none = noise.evidence().spread();
    EXPECT_EQ(none.spread, 0);
    EXPECT_EQ(none.freedom, 3u) << "all three of them";
    for (const auto& [station, shift] : none.shifts) EXPECT_EQ(shift, (Vec3d{0, 0, 0})) << station;
    // All are 0.
    EXPECT_EQ((Diagonal{{4, 4, 4}, {0, 0, 0}}.evidence().spread().spread), 0);
    EXPECT_EQ(StationEvidence().spread().stations, 0u);
    EXPECT_EQ(StationEvidence().spread().freedom, 0u);
}

// Equal weights: the spread, the freedom and the shifts can be written down.
TEST(StationEvidence, ShiftsAreDrawnTowards0ByTheNoise)
{
    const double weight = 4, alike = 1.5;
    const Diagonal equal{{4, 4, 4, 4, 4, 4}, {4, -8, 12, 4, 8, -12}};  // 1 -2 3 1 2 -3
    const StationSpread found = equal.evidence().spread(alike);
    const double squares = (1 + 4 + 9 + 1 + 4 + 9) / 6.0, noise2 = alike * alike / weight;
    EXPECT_NEAR(found.spread, std::sqrt(squares - noise2), 1e-6);
    EXPECT_EQ(found.freedom, std::lround(6 * std::pow(1 - noise2 / squares, 2)));
    ASSERT_EQ(found.shifts.size(), 2u);
    const double part = 1 - noise2 / squares;
    const Vec3d expected[] = {{part, -2 * part, 3 * part}, {part, 2 * part, -3 * part}};
    for (std::uint32_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(found.shifts.at(s)[a], expected[s][a], 1e-6) << s << a;
    // A surface of half the noise says four times as much.
    const StationSpread exact = equal.evidence(0.5).spread(2 * alike);
    EXPECT_NEAR(exact.spread, found.spread, 1e-9);
    EXPECT_EQ(exact.freedom, found.freedom);
    // However little is left of the differences, there is one.
    const Diagonal hardly{{1, 1, 1, 1, 1, 1}, {1, -1.2, 1, -1, 1, -1}};
    EXPECT_GT(hardly.evidence().spread().spread, 0);
    EXPECT_EQ(hardly.evidence().spread().freedom, 1u);
}

TEST(StationEvidence, WhatASurfaceHardlyShowsSaysNothing)
{
    const Diagonal weak{{1000, 1000, 1000, 0.9, 0.9, 1.1}, {2000, -2000, 2000, 90, 90, 2.2}};
    const StationSpread found = weak.evidence().spread();
    EXPECT_EQ(found.freedom, 4u) << "of a thousandth of the largest weight and more";
    EXPECT_EQ(found.shifts.at(1)[0], 0);
    EXPECT_EQ(found.shifts.at(1)[1], 0);
    EXPECT_GT(found.shifts.at(1)[2], 1);
    EXPECT_EQ((Diagonal{{0, 0, 0}, {0, 0, 0}}.evidence().spread().freedom), 0u);
}

// Two shifts that a surface only shows together: their difference is 2, and their mean not known.
TEST(StationEvidence, WhatAllShiftsHaveInCommonIsNotShown)
{
    StationEvidence evidence;
    const double w = 1e6;
    std::vector<double> h(36, 0.0);
    h[0] = h[21] = w;
    h[3] = h[18] = -w;
    evidence.add({7, 9}, h, {2 * w, 0, 0, -2 * w, 0, 0}, 1);
    const StationSpread found = evidence.spread();
    EXPECT_EQ(found.freedom, 1u);
    EXPECT_NEAR(found.spread, std::sqrt(2.0), 1e-3);
    EXPECT_NEAR(found.shifts.at(7)[0], 1, 1e-3);
    EXPECT_NEAR(found.shifts.at(9)[0], -1, 1e-3);
}

TEST(StationEvidence, SurfacesAreAdded)
{
    const Diagonal a = some_differences(), b{{50, 3, 8, 7, 20, 60}, {1, 2, 3, -4, -5, 60}};
    StationEvidence together, first, second, none;
    a.add_to(together, 0.5);
    b.add_to(together, 2, 1);  // stations 1 and 2
    a.add_to(first, 0.5);
    b.add_to(second, 2, 1);
    a.add_to(none, 0);
    EXPECT_EQ(none.stations(), 0u) << "no noise is known";
    first.add(second);
    first.add(none);
    EXPECT_EQ(first.stations(), 3u);
    const StationSpread x = together.spread(), y = first.spread();
    EXPECT_EQ(x.stations, 3u);
    EXPECT_EQ(x.spread, y.spread);
    EXPECT_EQ(x.shifts, y.shifts);
    // As one surface on which all of these differ.
    Diagonal sum{std::vector<double>(9, 0.0), std::vector<double>(9, 0.0)};
    for (std::size_t k = 0; k < 6; ++k) {
        sum.weights[k] += 4 * a.weights[k], sum.pulls[k] += 4 * a.pulls[k];
        sum.weights[k + 3] += b.weights[k] / 4, sum.pulls[k + 3] += b.pulls[k] / 4;
    }
    EXPECT_NEAR(sum.evidence().spread().spread, x.spread, 1e-9);
}

// Those with the least numbers.
TEST(StationEvidence, ManyStationsAreTheFirstOfThem)
{
    constexpr std::size_t most = StationEvidence::most_stations;
    for (const std::size_t count : {most, most + 5}) {
        Diagonal many;
        for (std::size_t k = 0; k < 3 * count; ++k) {
            many.weights.push_back(100);
            many.pulls.push_back(k < 3 * most ? (k % 2 ? 100 : -100) : 1e9);
        }
        const StationSpread found = many.evidence().spread();
        EXPECT_EQ(found.stations, most);
        EXPECT_EQ(found.shifts.size(), most);
        EXPECT_EQ(found.shifts.rbegin()->first, most - 1);
        EXPECT_NEAR(found.spread, std::sqrt(1 - 0.01), 1e-6);
    }
}

}  // namespace
