// Sizes of points against the distances to all other points.

#include "pcm/build/nodes/point_sizes.h"

#include "pcm/build/levels/lattice.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/tree/point_size.h"
#include "tests/build/schema_of.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace pcm {
namespace {

template <class Coord>
using Cloud = std::vector<Point<Coord>>;

constexpr double round_up = 1.1893;  // a code is at most a quarter octave above its size

// Points with the sizes that they got, at different places, in Morton order.
template <class Coord>
struct Sized {
    Cloud<Coord> places;
    std::vector<std::uint8_t> codes;
    std::vector<long double> exact;  // to the fourth neighbour at another place, or the last; source units
};

template <class Coord>
std::vector<std::byte> sorted_rows(const Cloud<Coord>& cloud, const Grid& grid, const RowLayout& layout)
{
    std::vector<std::byte> rows(cloud.size() * layout.bytes), sorted;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        std::memcpy(rows.data() + i * layout.bytes, cloud[i].data(), sizeof cloud[i]);
        std::memcpy(rows.data() + i * layout.bytes + layout.offsets[0], &i, 2);  // other attributes at one place
    }
    for (const std::uint32_t i : morton_order<Coord>(rows.data(), cloud.size(), layout, Lattice(grid).finer))
        sorted.insert(sorted.end(), rows.data() + i * layout.bytes, rows.data() + (i + 1) * layout.bytes);
    return sorted;
}

template <class Coord>
std::vector<long double> exact_distances(const Cloud<Coord>& places, const Grid& grid)
{
    std::vector<long double> exact;
    for (const auto& p : places) {
        std::array<long double, 5> nearest;  // the point itself among them
        nearest.fill(std::numeric_limits<long double>::infinity());
        for (const auto& q : places) {
            long double sum = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const long double d = (static_cast<long double>(p[a]) - static_cast<long double>(q[a])) *
                                      static_cast<long double>(grid.scale[a]);
                sum += d * d;
            }
            for (long double& n : nearest)
                if (sum < n) std::swap(sum, n);
        }
        std::size_t last = std::min<std::size_t>(4, places.size() - 1);
        exact.push_back(std::sqrt(nearest[last]));
    }
    return exact;
}

template <class Coord>
Sized<Coord> sizes_of(const Cloud<Coord>& cloud, const Grid& grid)
{
    const RowLayout layout(test::schema_of({{ScalarType::u16, 1}}), sizeof(Coord) == 8);
    const std::vector<std::byte> rows = sorted_rows(cloud, grid, layout);
    const auto codes = find_sizes<Coord>(rows.data(), cloud.size(), layout.bytes, grid);
    EXPECT_EQ(codes.size(), cloud.size());
    Sized<Coord> sized;
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const auto p = coordinates_of<Coord>(rows.data() + i * layout.bytes);
        if (!sized.places.empty() && sized.places.back() == p) {
            EXPECT_EQ(codes[i], sized.codes.back()) << "two sizes at one place";
            continue;
        }
        sized.places.push_back(p);
        sized.codes.push_back(codes[i]);
    }
    if (!sized.places.empty()) sized.exact = exact_distances(sized.places, grid);
    return sized;
}

long double middle_of(std::vector<long double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

// No size is below its distance, unless one of the two limits makes it so: those found are no smaller than the exact
// ones, and so are their middles.
template <class Coord>
void expect_large_enough(const Sized<Coord>& sized, const Grid& grid)
{
    const double least = least_point_size(grid);
    std::vector<long double> middles;
    for (std::size_t first = 0; first < sized.exact.size(); first += 32) {
        // The last group may have fewer points: then points before it count, too.
        const std::size_t last = std::min(first + 32, sized.exact.size()), count = std::min<std::size_t>(last, 32);
        const auto end = sized.exact.begin() + static_cast<std::ptrdiff_t>(last);
        middles.push_back(middle_of({end - static_cast<std::ptrdiff_t>(count), end}));
    }
    const long double most = 16 * middle_of(middles);
    for (std::size_t i = 0; i < sized.exact.size(); ++i) {
        const long double expected = std::min({sized.exact[i], 1.5L * middles[i / 32], most});
        ASSERT_NE(sized.codes[i], unknown_size);
        if (sized.codes[i] == 255) continue;  // the largest that there is
        ASSERT_GE(static_cast<long double>(point_size(sized.codes[i], least)), expected * (1 - 1e-6L)) << i;
    }
}

struct Ratios {
    double same = 0;        // the share of points whose code is that of the exact distance
    double twice_most = 0;  // and of those whose size is at most twice it
};

template <class Coord>
Ratios ratios_of(const Sized<Coord>& sized, const Grid& grid)
{
    const double least = least_point_size(grid);
    Ratios ratios;
    for (std::size_t i = 0; i < sized.exact.size(); ++i) {
        const int exact = size_code(static_cast<double>(sized.exact[i]), least), code = sized.codes[i];
        ratios.same += code == exact;
        ratios.twice_most += code <= exact + sizes_per_octave;
    }
    const auto count = static_cast<double>(sized.exact.size());
    return {ratios.same / count, ratios.twice_most / count};
}

template <class Coord>
class PointSizesOfBins : public testing::Test {
protected:
    // Around the middle of the range, where neighbours may differ in all bits, `count` points over `extent` steps.
    Cloud<Coord> points(const std::string& kind, std::size_t count, Coord extent)
    {
        const Coord middle = coordinate_bias<Coord>;
        Cloud<Coord> cloud;
        const auto any = [&] { return static_cast<Coord>(random_() % extent); };
        for (std::size_t i = 0; i < count; ++i) {
            Point<Coord> p{any(), any(), any()};
            if (kind == "surface") p[2] = static_cast<Coord>(p[0] / 3 + p[1] / 5);
            if (kind == "line") p[1] = p[0] / 2, p[2] = p[0] / 7;
            if (kind == "piles")
                for (Coord& c : p) c = c % 7 * (extent / 7);
            for (Coord& c : p) c = static_cast<Coord>(c + middle - extent / 2);
            cloud.push_back(p);
        }
        return cloud;
    }
    std::mt19937_64 random_{7};
    const Grid grid_{{0.001, 0.001, 0.001}, {5e6, 4e5, -1}};
};
using Widths = testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(PointSizesOfBins, Widths);

// Not under the thread sanitizer: all of it runs in one thread.
PCM_TYPED_TEST(PointSizesOfBins, PCM_NOT_UNDER_THREAD(AreDistancesToTheFourthNeighbour))
{
    for (const std::string kind : {"surface", "volume", "line", "piles"})
        for (const std::size_t count : {2u, 3u, 4u, 5u, 6u, 31u, 32u, 33u, 64u, 65u, 97u, 3000u})
            for (const TypeParam extent : {TypeParam(200000), TypeParam(1) << 27}) {
                SCOPED_TRACE(kind + ", " + std::to_string(count) + " points over " + std::to_string(extent));
                const auto sized = sizes_of(this->points(kind, count, extent), this->grid_);
                if (sized.places.size() < 2) continue;
                expect_large_enough(sized, this->grid_);
                const Ratios ratios = ratios_of(sized, this->grid_);
                if (count <= 33) EXPECT_EQ(ratios.twice_most, 1);
                EXPECT_GT(ratios.same, 0.5);
                EXPECT_GE(ratios.twice_most, 0.99);
                if (this->HasFailure()) return;
            }
}

// Two points for every place that lies alone, four, and hundreds: piles count as one neighbour.
PCM_TYPED_TEST(PointSizesOfBins, PCM_NOT_UNDER_THREAD(PilesAreOneNeighbour))
{
    auto cloud = this->points("surface", 500, 100000);
    const auto alone = sizes_of(cloud, this->grid_);
    const auto once = cloud;
    for (std::size_t i = 0; i < once.size(); ++i) cloud.insert(cloud.end(), i % 50 ? i % 5 : 300, once[i]);
    const auto piled = sizes_of(cloud, this->grid_);
    EXPECT_EQ(piled.places, alone.places);
    EXPECT_EQ(piled.codes, alone.codes);
}

PCM_TYPED_TEST(PointSizesOfBins, PCM_NOT_UNDER_THREAD(AreNotKnownAtASinglePlace))
{
    const RowLayout layout(test::schema_of({{ScalarType::u16, 1}}), sizeof(TypeParam) == 8);
    EXPECT_TRUE(find_sizes<TypeParam>(nullptr, 0, layout.bytes, this->grid_).empty());
    for (const std::size_t count : {1u, 2u, 100u}) {
        const Cloud<TypeParam> pile(count, {1, std::numeric_limits<TypeParam>::max(), 0});
        const auto rows = sorted_rows(pile, this->grid_, layout);
        EXPECT_EQ(find_sizes<TypeParam>(rows.data(), count, layout.bytes, this->grid_),
                  std::vector<std::uint8_t>(count, unknown_size));
    }
}

// The ends of the range, and one point ten million spacings away at either side: nothing is rounded away.
PCM_TYPED_TEST(PointSizesOfBins, PCM_NOT_UNDER_THREAD(OfCoordinatesFarApart))
{
    for (const TypeParam shift : {TypeParam(0), TypeParam(std::numeric_limits<TypeParam>::max() - 40000)}) {
        auto cloud = this->points("surface", 2000, 1000);
        for (auto& p : cloud)
            for (TypeParam& c : p) c = static_cast<TypeParam>(c - coordinate_bias<TypeParam> + 500 + shift);
        const TypeParam away = shift ? shift - 200000000 : 200000000;
        cloud.push_back({away, away, away});
        const auto sized = sizes_of(cloud, this->grid_);
        expect_large_enough(sized, this->grid_);
        const Ratios ratios = ratios_of(sized, this->grid_);
        EXPECT_GT(ratios.same, 0.5);
        EXPECT_GE(ratios.twice_most, 0.99);
    }
    const TypeParam end = std::numeric_limits<TypeParam>::max();
    const auto corners = sizes_of(Cloud<TypeParam>{{0, 0, 0}, {end, 0, 0}, {0, end, 0}, {end, end, end}}, this->grid_);
    expect_large_enough(corners, this->grid_);
}

PCM_TYPED_TEST(PointSizesOfBins, PCM_NOT_UNDER_THREAD(OfGridsOfAnyScale))
{
    const auto cloud = this->points("surface", 1000, 5000);
    const auto usual = sizes_of(cloud, Grid{{1, 1, 1}, {0, 0, 0}});
    for (const double scale : {1e-300, 1e-30, 1e30, 1e300}) {
        const Grid grid{{scale, scale, scale}, {0, 0, 0}};
        const auto sized = sizes_of(cloud, grid);
        // Square roots of the scale may round to the next code.
        for (std::size_t i = 0; i < usual.codes.size(); ++i) ASSERT_NEAR(sized.codes[i], usual.codes[i], 1);
        expect_large_enough(sized, grid);
    }
    const Grid flat{{0.5, 0.001, 2}, {0, 0, 0}};
    const auto sized = sizes_of(cloud, flat);
    expect_large_enough(sized, flat);
    EXPECT_GT(ratios_of(sized, flat).same, 0.5);
}

// A point that stands alone is no larger than its surroundings, also where it is the last in Morton order and the only
// one of its group; nor are many.
PCM_TYPED_TEST(PointSizesOfBins, PCM_NOT_UNDER_THREAD(PointsThatStandAloneAreLimited))
{
    for (const std::size_t loners : {0u, 1u, 10u, 100u}) {
        auto cloud = this->points("surface", 4000, 100000);
        const auto before = sizes_of(cloud, this->grid_);
        ASSERT_EQ(before.places.size(), 4000u);  // 125 groups
        const double usual = static_cast<double>(middle_of(before.exact));
        for (std::size_t i = 0; i < std::max<std::size_t>(1, loners); ++i) {
            Point<TypeParam> p = cloud[i];
            if (loners == 0) p.fill(coordinate_bias<TypeParam> + 500000000);
            p[2] = static_cast<TypeParam>(p[2] + 500000000 + 1000000 * i);
            cloud.push_back(p);
        }
        const auto sized = sizes_of(cloud, this->grid_);
        if (loners == 0) EXPECT_EQ(sized.places.back(), cloud.back());
        expect_large_enough(sized, this->grid_);
        const double largest =
            point_size(*std::max_element(sized.codes.begin(), sized.codes.end()), least_point_size(this->grid_));
        EXPECT_LT(largest, round_up * (loners < 100 ? 3 : 80) * usual);
        EXPECT_GT(static_cast<double>(*std::max_element(sized.exact.begin(), sized.exact.end())), 500 * usual);
    }
}

// Not the order in which they come: what a bin's points are decides their sizes.
PCM_TYPED_TEST(PointSizesOfBins, PCM_NOT_UNDER_THREAD(DependOnTheSetAlone))
{
    auto cloud = this->points("surface", 1000, 3000);
    const auto copies = this->points("piles", 200, 3000);
    cloud.insert(cloud.end(), copies.begin(), copies.end());
    const auto first = sizes_of(cloud, this->grid_);
    for (int round = 0; round < 3; ++round) {
        std::shuffle(cloud.begin(), cloud.end(), this->random_);
        const auto again = sizes_of(cloud, this->grid_);
        EXPECT_EQ(again.places, first.places);
        EXPECT_EQ(again.codes, first.codes);
    }
}

}  // namespace
}  // namespace pcm
