// Statistics of a cloud against sums by hand.
#include "pcm/cloud/statistics.h"

#include "pcm/cloud/with_type.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

namespace {

using namespace pcm;

Schema schema_of(const std::vector<Attribute>& attributes)
{
    Schema schema;
    for (const Attribute& attribute : attributes) schema.add(attribute);
    return schema;
}

TEST(Statistics, RangesMeansAndHistograms)
{
    const Schema schema = schema_of({{"classification", ScalarType::u8, 1, 1, 0, ""},
                                     {"return_number", ScalarType::u8, 1, 1, 0, ""},
                                     {"number_of_returns", ScalarType::u8, 1, 1, 0, ""},
                                     {"angle", ScalarType::i16, 1, 0.006, 1, ""},
                                     {"down", ScalarType::i32, 1, -2, 0, ""},
                                     {"pair", ScalarType::f32, 2, 1, 0, ""},
                                     {"big", ScalarType::u64, 1, 1, 0, ""}});
    const Grid grid{{0.01, 0.1, 1}, {1000, -5, 0}};
    std::mt19937_64 random(1);
    StatisticsCollector collector(schema, grid);
    std::map<int, std::uint64_t> classes, returns;
    double sum_x = 0, sum_angle = 0, sum_pair = 0, least_pair = 1e9, most_pair = -1e9, least_down = 1e9,
           most_down = -1e9;
    std::uint64_t points = 0, nan = 0;
    for (const std::size_t size : {1u, 1000u, 0u, 65536u}) {
        PointBatch batch;
        batch.reset(schema, true, size);
        for (std::size_t i = 0; i < size; ++i) {
            for (std::size_t a = 0; a < 3; ++a) batch.grid_xyz[a][i] = static_cast<std::int32_t>(random());
            sum_x += batch.grid_xyz[0][i] * 0.01 + 1000;
            const auto of = [&](std::size_t k) -> Column& { return batch.attributes[k]; };
            ++classes[of(0).as<std::uint8_t>()[i] = static_cast<std::uint8_t>(random())];
            ++returns[of(1).as<std::uint8_t>()[i] = static_cast<std::uint8_t>(random() % 5)];
            of(2).as<std::uint8_t>()[i] = 7;
            sum_angle += 1 + 0.006 * (of(3).as<std::int16_t>()[i] = static_cast<std::int16_t>(random()));
            const double down = -2.0 * (of(4).as<std::int32_t>()[i] = static_cast<std::int32_t>(random() % 1000));
            least_down = std::min(least_down, down);
            most_down = std::max(most_down, down);
            const bool bad = random() % 10 == 0;
            const auto value = static_cast<float>(random() % 1000) * 0.5f - 100;
            of(5).as<float>()[2 * i] = bad ? std::numeric_limits<float>::quiet_NaN() : value;
            of(5).as<float>()[2 * i + 1] = std::numeric_limits<float>::infinity();
            nan += bad;
            if (!bad) {
                sum_pair += value;
                least_pair = std::min<double>(least_pair, value);
                most_pair = std::max<double>(most_pair, value);
            }
            of(6).as<std::uint64_t>()[i] = std::numeric_limits<std::uint64_t>::max();
        }
        points += size;
        collector.add(batch);
    }
    const CloudStatistics found = collector.result();
    EXPECT_EQ(found.points, points);
    EXPECT_EQ(found.not_finite, 0u);
    const auto n = static_cast<double>(points);
    EXPECT_NEAR(found.position[0].mean, sum_x / n, std::fabs(sum_x / n) * 1e-9 + 1e-6);
    EXPECT_EQ(found.position[0].least, found.box.min[0]);
    EXPECT_EQ(found.position[2].most, found.box.max[2]);
    for (int c = 0; c < 256; ++c) EXPECT_EQ(found.classes[static_cast<std::size_t>(c)], classes[c]) << c;
    EXPECT_EQ(found.other_classes, 0u);
    for (int r = 0; r < 256; ++r) EXPECT_EQ(found.return_numbers[static_cast<std::size_t>(r)], returns[r]) << r;
    EXPECT_EQ(found.numbers_of_returns[7], points);
    EXPECT_NEAR(found.attributes[3][0].mean, sum_angle / n, 1e-6);
    EXPECT_EQ(found.attributes[4][0].least, least_down);
    EXPECT_EQ(found.attributes[4][0].most, most_down);
    const ValueStatistics& pair = found.attributes[5][0];
    EXPECT_EQ(pair.values, points - nan);
    EXPECT_EQ(pair.not_finite, nan);
    EXPECT_EQ(pair.least, least_pair);
    EXPECT_EQ(pair.most, most_pair);
    EXPECT_NEAR(pair.mean, sum_pair / static_cast<double>(points - nan), 1e-6);
    EXPECT_EQ(found.attributes[5][1].values, 0u);
    EXPECT_EQ(found.attributes[5][1].not_finite, points);
    EXPECT_EQ(found.attributes[6][0].mean, 0x1p64);
}

// Values at the ends of what is counted one by one, in types that hold more.
// Sums of doubles near the largest are beyond it, their mean is not.
TEST(Statistics, MeansOfTheLargestAndTheLeastDoubles)
{
    constexpr double largest = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
    const Schema schema = schema_of({{"large", ScalarType::f64, 1, 1, 0, ""}, {"small", ScalarType::f64, 1, 1, 0, ""}});
    StatisticsCollector collector(schema, {});
    PointBatch batch;
    batch.reset(schema, false, 1000);
    std::fill_n(batch.attributes[0].as<double>(), 1000, largest);
    std::fill_n(batch.attributes[1].as<double>(), 1000, least);
    collector.add(batch);
    collector.add(batch);
    EXPECT_EQ(collector.result().attributes[0][0].mean, largest);
    EXPECT_EQ(collector.result().attributes[1][0].mean, least);
}

TEST(Statistics, ClassesOutsideABytesRangeAreCountedTogether)
{
    for (const ScalarType type : {ScalarType::i8, ScalarType::u8, ScalarType::i16, ScalarType::u16, ScalarType::i32,
                                  ScalarType::u32, ScalarType::i64, ScalarType::u64}) {
        const Schema schema = schema_of({{"classification", type, 1, 1, 0, ""}});
        const std::int64_t edges[] = {0, 1, 255, 256, 257, -1, -128, 32767, -32768, 70000, 255};
        std::map<std::int64_t, std::uint64_t> expected;
        std::uint64_t others = 0;
        PointBatch batch;
        batch.reset(schema, true, std::size(edges));
        for (std::size_t i = 0; i < std::size(edges); ++i)
            with_type(type, [&](auto zero) {
                using T = decltype(zero);
                const T value = batch.attributes[0].as<T>()[i] = static_cast<T>(edges[i]);
                const bool counted = value >= 0 && static_cast<std::uint64_t>(value) <= 255;
                ++(counted ? expected[static_cast<std::int64_t>(value)] : others);
            });
        StatisticsCollector collector(schema, Grid{});
        collector.add(batch);
        const CloudStatistics found = collector.result();
        ASSERT_EQ(found.classes.size(), 256u);
        for (std::size_t c = 0; c < 256; ++c)
            EXPECT_EQ(found.classes[c], expected[static_cast<std::int64_t>(c)]) << c << " of type " << int(type);
        EXPECT_EQ(found.other_classes, others) << int(type);
    }
}

// Not integers of one component: there are no counts.
TEST(Statistics, ScaledOrFloatingClassesAreNotCounted)
{
    for (const Attribute& attribute : std::vector<Attribute>{{"classification", ScalarType::u8, 2, 1, 0, ""},
                                                             {"classification", ScalarType::u8, 1, 0.5, 0, ""},
                                                             {"classification", ScalarType::u8, 1, 1, 1, ""},
                                                             {"classification", ScalarType::f32, 1, 1, 0, ""},
                                                             {"classification", ScalarType::f64, 1, 1, 0, ""},
                                                             {"class", ScalarType::u8, 1, 1, 0, ""}}) {
        const Schema schema = schema_of({attribute});
        PointBatch batch;
        batch.reset(schema, true, 3);
        StatisticsCollector collector(schema, Grid{});
        collector.add(batch);
        const CloudStatistics found = collector.result();
        EXPECT_TRUE(found.classes.empty()) << attribute.name << " " << attribute.scale;
        EXPECT_EQ(found.other_classes, 0u);
    }
}

// Points on a coarse lattice, so that many coincide.
double count_duplicates(std::size_t points, std::int32_t side, bool gridded, StatisticsCollector& collector)
{
    std::mt19937_64 random(points);
    std::set<std::array<std::int32_t, 3>> seen;
    std::size_t repeated = 0;
    for (std::size_t done = 0; done < points;) {
        const std::size_t size = std::min<std::size_t>(points - done, 5000);
        PointBatch batch;
        batch.reset({}, gridded, size);
        for (std::size_t i = 0; i < size; ++i) {
            std::array<std::int32_t, 3> p;
            for (std::size_t a = 0; a < 3; ++a) {
                p[a] = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(side));
                if (gridded)
                    batch.grid_xyz[a][i] = p[a];
                else
                    batch.xyz[a][i] = p[a] == 0 && random() % 2 ? -0.0 : p[a] * 0.1;
            }
            repeated += !seen.insert(p).second;
        }
        collector.add(batch);
        done += size;
    }
    return static_cast<double>(repeated);
}

TEST(Statistics, DuplicatesAreExactWhileTheyFitTheMemory)
{
    for (const bool gridded : {true, false})
        for (const std::int32_t side : {1, 20, 40, 1000000}) {
            StatisticsCollector collector({}, gridded ? std::optional<Grid>(Grid{}) : std::nullopt);
            const double expected = count_duplicates(40000, side, gridded, collector);
            const DuplicateStatistics found = collector.result().duplicates;
            EXPECT_TRUE(found.exact);
            EXPECT_EQ(found.points, expected) << side;
            EXPECT_EQ(found.standard_error, 0);
        }
}

// Beyond it they are an estimate within its error: five standard errors are exceeded once in a million.
TEST(Statistics, DuplicatesBeyondTheMemoryAreAnEstimateWithItsError)
{
    for (const std::size_t most : {1000u, 6000u}) {
        StatisticsCollector collector({}, Grid{}, most);
        const double expected = count_duplicates(60000, 25, true, collector);  // 15,625 positions
        const DuplicateStatistics found = collector.result().duplicates;
        EXPECT_FALSE(found.exact);
        EXPECT_GE(found.one_in, 15000 / most);
        EXPECT_NEAR(found.points, expected, 5 * found.standard_error) << most;
        EXPECT_GT(found.standard_error, 0);
        EXPECT_LT(found.standard_error, 0.2 * expected);
    }
}

TEST(Statistics, PointsWithoutAPositionAreCounted)
{
    StatisticsCollector collector({}, std::nullopt);
    PointBatch batch;
    batch.reset({}, false, 4);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    batch.xyz = {std::vector<double>{1, nan, nan, 1}, {2, 2, 2, 2}, {3, 3, 3, 3}};
    collector.add(batch);
    const CloudStatistics found = collector.result();
    EXPECT_EQ(found.points, 4u);
    EXPECT_EQ(found.not_finite, 2u);
    EXPECT_EQ(found.position[0].not_finite, 2u);
    EXPECT_EQ(found.duplicates.points, 1);
    EXPECT_EQ(found.box.min, (Vec3d{1, 2, 3}));
    const CloudStatistics none = StatisticsCollector({}, Grid{}).result();
    EXPECT_EQ(none.points, 0u);
    EXPECT_EQ(none.position[0].mean, 0);
    EXPECT_TRUE(none.box.empty());
}

}  // namespace
