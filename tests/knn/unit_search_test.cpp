#include "pcm/knn/unit_search.h"

#include "tests/knn/search_clouds.h"
#include "tests/knn/simd_levels.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <thread>

namespace pcm {
namespace {

using namespace search_clouds;

constexpr double unbounded = std::numeric_limits<double>::infinity();

// All of these k, at each level of instructions.
void expect_exact(const SearchPositions& p, std::initializer_list<std::size_t> ks = {1, 7, 16, 17, 33, 200},
                  double max_distance = unbounded, std::size_t stride = 1)
{
    at_each_level([&] {
        for (const std::size_t k : ks) {
            SCOPED_TRACE("k = " + std::to_string(k));
            const Comparison c = compare(p, {k, max_distance}, nullptr, stride);
            ASSERT_EQ(c.first_mistake, "");
            ASSERT_EQ(c.queries, p.size());
        }
    });
}

Vec3i on_lattice(std::size_t i, std::int64_t side, Vec3i step)
{
    const auto n = static_cast<std::int64_t>(i);
    return {n % side * step[0], n / side % side * step[1], n / side / side * step[2]};
}

// Not under the thread sanitizer, nor most of the following: an oracle in one thread takes nearly all of the time.
TEST(UnitSearch, PCM_NOT_UNDER_THREAD(Random))
{
    expect_exact(narrow(1500, InBox(1000, 1000, 1000)));
    expect_exact(narrow(1500, InBox(1000000, 1000000, 20)));
    expect_exact(narrow(1500, InBox(1 << 29, 1 << 29, 1 << 29)));
}

TEST(UnitSearch, EverySizeAroundLeaves)
{
    for (std::size_t n : {1, 2, 3, 31, 32, 33, 63, 64, 65, 95, 96, 97, 129, 200})
        expect_exact(narrow(n, InBox(100, 100, 100, static_cast<unsigned>(n))), {1, 5, 16, 40, 300});
}

TEST(UnitSearch, NoPoints)
{
    make_unit_search(SearchPositions{})->search(nullptr, {}, [](const FoundNeighbours&) { FAIL(); });
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(Lattices))
{
    const auto lattice = [](Vec3i step, Vec3d scale) {
        return narrow(
            1331, [=](std::size_t i) { return on_lattice(i, 11, step); }, scale);
    };
    const auto check = [](const SearchPositions& p) { expect_exact(p, {1, 7, 16, 33}, unbounded, 5); };
    check(lattice({1, 1, 1}, {1, 1, 1}));
    check(lattice({1, 1, 1}, {0.01, 0.01, 0.01}));
    check(lattice({1, 1, 1}, {0.01, 0.01, 0.001}));
    check(lattice({10, 10, 1}, {0.001, 0.001, 0.01}));
    check(lattice({3, 5, 7}, {0.7, 1.1, 1.3}));
    // Squares beyond what single precision holds.
    check(lattice({10000019, 10000019, 10000019}, {1, 1, 1}));
    check(lattice({100003, 100003, 100003}, {1e-6, 1e-6, 1e-6}));
}

// Neighbours whose squares differ by less than single precision shows.
TEST(UnitSearch, PCM_NOT_UNDER_THREAD(AlmostTies))
{
    std::mt19937 random(3);
    const auto p = narrow(900, [&](std::size_t i) {
        const Vec3i at = on_lattice(i, 10, {1 << 21, 1 << 21, 1 << 21});
        return Vec3i{at[0] + std::int64_t(random() % 3), at[1] + std::int64_t(random() % 3), at[2]};
    });
    expect_exact(p);
    expect_exact(narrow(900,
                        [&](std::size_t i) {
                            return on_lattice(i, 10, {4000 + int(i % 2), 4001, 4002});
                        },
                        {0.5, 0.5, 0.500001}));
}

// Single precision loses the more the farther apart the queries of a leaf are: here more than their distances.
TEST(UnitSearch, PCM_NOT_UNDER_THREAD(SmallClustersFarApart))
{
    for (const std::int64_t spread : {1000ll, 30ll, 2ll}) {
        InBox far(1 << 29, 1 << 29, 1 << 29), near(spread, spread, spread);
        std::vector<Vec3i> centres;
        for (int i = 0; i < 100; ++i) centres.push_back(far());
        const auto place = [&](std::size_t i) {
            const Vec3i c = centres[i % centres.size()], d = near();
            return Vec3i{c[0] + d[0], c[1] + d[1], c[2] + d[2]};
        };
        expect_exact(narrow(900, place), {1, 3, 8, 16});
        expect_exact(narrow(900, place, {1, 1.25, 0.3}), {1, 3, 8, 16});
    }
}

// A small part of a large extent, so that its offsets are small in any unit.
TEST(UnitSearch, PCM_NOT_UNDER_THREAD(DifferentScalesBesideAStray))
{
    for (const int bits : {30, 45, 55}) {
        const auto place = [&](std::size_t i) { return i ? on_lattice(i, 9, {1, 1, 1}) : Vec3i{1ll << bits, 0, 0}; };
        expect_exact(wide(729, place, {1, 1.25, 1.00000001}), {1, 2, 3, 8, 16});
    }
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(ListsOfAllLengths))
{
    const auto p = narrow(400, InBox(1000, 1000, 1000));
    expect_exact(p, {2, 8, 9, 15, 24, 25, 31, 32, 40, 41, 48, 49, 56, 57, 64, 65, 96, 97, 192, 193, 399, 400},
                 unbounded, 7);
}

// Under no sanitizer: minutes there, of what other tests run too.
TEST(UnitSearch, PCM_NOT_UNDER_SANITIZERS(ManyPoints))
{
    expect_exact(narrow(200000, InBox(100000, 100000, 300)), {16, 40}, unbounded, 2003);
    expect_exact(narrow(100000, InBox(1 << 30, 1 << 30, 1 << 30)), {16}, unbounded, 2003);
    expect_exact(wide(50000, InBox(1ll << 50, 1ll << 50, 1ll << 40), {1e-6, 1e-6, 1e-5}), {16}, unbounded, 1009);
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(Duplicates))
{
    expect_exact(narrow(1000, InBox(3, 3, 3)));
    expect_exact(narrow(600, [](std::size_t) { return Vec3i{5, -7, 9}; }));
    expect_exact(narrow(600, [](std::size_t i) { return Vec3i{i % 10 ? 0 : std::int64_t(i), 0, 0}; }));
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(LinesAndPlanes))
{
    expect_exact(narrow(1000, InBox(100000, 0, 0)));
    expect_exact(narrow(1000, [](std::size_t i) { return Vec3i{std::int64_t(i), 2 * std::int64_t(i), 0}; }));
    expect_exact(narrow(1000, InBox(0, 1000, 1000)));
    expect_exact(narrow(1000, InBox(20, 20, 0)));
}

// Under no sanitizer: minutes there, of what other tests run too.
TEST(UnitSearch, PCM_NOT_UNDER_SANITIZERS(MapExtents))
{
    // All of the 32 bits: differences need 33.
    expect_exact(narrow(1500, InBox(2147483647, 2147483647, 2147483647)));
    expect_exact(narrow(1500, InBox(2147483647, 1000000, 10)));
    expect_exact(narrow(600, [](std::size_t i) {
        return Vec3i{i % 2 ? 2147483647 : -2147483648ll, std::int64_t(i), std::int64_t(i / 7)};
    }));
}

// Under no sanitizer: minutes there, of what other tests run too.
TEST(UnitSearch, PCM_NOT_UNDER_SANITIZERS(WidePositions))
{
    expect_exact(wide(1500, InBox(1ll << 61, 1ll << 61, 1ll << 61)));
    expect_exact(wide(1500, InBox(1ll << 45, 1ll << 40, 1ll << 20), {1e-6, 1e-6, 1e-6}));
    expect_exact(wide(1500, InBox(1000, 1000, 1000), {1e-9, 1e-9, 1e-9}));
    expect_exact(wide(1500, InBox(1ll << 50, 1ll << 50, 1ll << 50), {1e-6, 2e-6, 1e-3}));
    // Far from the origin of the steps.
    InBox near(1000, 1000, 1000);
    expect_exact(wide(1000, [&](std::size_t) {
        const Vec3i at = near();
        return Vec3i{at[0] + (1ll << 60), at[1] - (1ll << 60), at[2] + (1ll << 61)};
    }));
}

// Each extent from 1e-6 to 1e9 source units with steps that fit it, and with steps a thousand times finer.
TEST(UnitSearch, PCM_NOT_UNDER_THREAD(TinyAndLargeExtents))
{
    for (const double extent : {1e-6, 1.0, 1e9})
        for (const double steps : {1e6, 1e9, 1e15}) {
            const auto half = static_cast<std::int64_t>(steps / 2);
            const double scale = extent / steps;
            expect_exact(wide(700, InBox(half, half, half / 10), {scale, scale, scale}), {1, 16});
            expect_exact(wide(700, InBox(half, half, half / 10), {scale, scale, scale}), {1, 16}, extent / 20);
        }
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(ClustersAndStrays))
{
    for (const std::int64_t far : {1000000ll, 1000000000ll, 1000000000000ll, 1ll << 61}) {
        InBox near(50, 50, 50), cluster(1000, 1000, 1000);
        expect_exact(wide(800,
                          [&](std::size_t i) {
                              Vec3i at = i % 2 ? near() : cluster();
                              if (i % 2) at[0] += far;
                              return at;
                          }),
                     {1, 16, 33});
        expect_exact(wide(800,
                          [&](std::size_t i) {
                              return i < 3 ? Vec3i{far, far / (std::int64_t(i) + 1), 0} : near();
                          }),
                     {1, 16, 33});
    }
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(ScalesFarApart))
{
    expect_exact(narrow(700, InBox(1000, 1000, 1000), {1, 1e-5, 1e5}), {1, 16});
    expect_exact(narrow(700, InBox(1000, 1000, 1000), {1, 1e-20, 1e20}), {1, 16});
    expect_exact(narrow(300, InBox(0, 1000, 1000), {1, 1e-40, 1e-40}), {1, 16});
    expect_exact(narrow(300, InBox(1, 1000, 1000), {1, 1e-40, 1e-40}), {1, 16});
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(MaxDistanceIsInclusive))
{
    const auto lattice = narrow(1000, [](std::size_t i) { return on_lattice(i, 10, {5, 5, 5}); });
    for (const double distance : {0.0, 4.999999, 5.0, 5.000001, 10.0, 1000.0})
        expect_exact(lattice, {1, 16, 33}, distance);
    const auto fine = narrow(1000,
                             [](std::size_t i) {
                                 return on_lattice(i, 10, {5000, 5000, 5000});
                             },
                             {1e-3, 1e-3, 1e-3});
    for (const double distance : {4.999999999999999, 5.0, 5.000000000000001}) expect_exact(fine, {4, 6, 16}, distance);
    expect_exact(narrow(1000, InBox(100, 100, 100)), {1, 16, 200}, 25);
    expect_exact(narrow(1000, InBox(2, 2, 2)), {1, 16, 200}, 0);
    expect_exact(wide(700, InBox(1ll << 50, 1ll << 50, 1ll << 50)), {16}, std::ldexp(1, 48));
}

TEST(UnitSearch, PCM_NOT_UNDER_THREAD(SomeQueries))
{
    const auto p = narrow(2000, InBox(1000, 1000, 10));
    at_each_level([&] {
        for (const std::size_t step : {1, 2, 7, 100, 1999}) {
            std::vector<std::uint32_t> queries;
            for (std::size_t i = 0; i < p.size(); i += step)
                queries.push_back(static_cast<std::uint32_t>(p.size() - 1 - i));
            const Comparison c = compare(p, {16, unbounded}, &queries);
            EXPECT_EQ(c.first_mistake, "");
            EXPECT_EQ(c.queries, queries.size());
        }
        const std::vector<std::uint32_t> none;
        EXPECT_EQ(compare(p, {16, unbounded}, &none).queries, 0u);
        EXPECT_EQ(compare(p, {0, unbounded}).first_mistake, "");
    });
}

TEST(UnitSearch, ManyThreadsMaySearch)
{
    const auto p = narrow(3000, InBox(1000, 1000, 10));
    const auto search = make_unit_search(p);
    std::vector<std::string> mistakes(4);
    std::vector<std::thread> threads;
    for (std::uint32_t t = 0; t < mistakes.size(); ++t)
        threads.emplace_back([&, t] {
            std::vector<std::uint32_t> queries;
            for (std::uint32_t i = t; i < p.size(); i += 3) queries.push_back(i);
            mistakes[t] = compare(*search, p, {16, unbounded}, &queries, 5).first_mistake;
        });
    for (std::thread& thread : threads) thread.join();
    for (const std::string& mistake : mistakes) EXPECT_EQ(mistake, "");
}

// The same points in the same order, whatever the processor.
TEST(UnitSearch, PCM_NOT_UNDER_THREAD(AllLevelsAgree))
{
    for (const bool fine : {false, true}) {
        const std::int64_t half = fine ? 100000000 : 100;
        const auto p = narrow(3000, InBox(half, half, half / 20));
        std::vector<std::uint32_t> first;
        at_each_level([&] {
            std::vector<std::uint32_t> all;
            make_unit_search(p)->search(nullptr, {16, unbounded}, [&](const FoundNeighbours& found) {
                all.insert(all.end(), found.neighbours, found.neighbours + found.size * found.stride);
            });
            if (first.empty()) first = all;
            EXPECT_EQ(all, first);
        });
    }
}

// Inputs on which a search of this kind may become quadratic. The bounds, in seconds of the processor, are generous.
TEST(UnitSearch, PCM_NOT_UNDER_THREAD(StiffInputsStayFast))
{
    const auto seconds = [](const SearchPositions& p, std::size_t k) {
        const std::clock_t begin = std::clock();
        std::size_t queries = 0;
        make_unit_search(p)->search(nullptr, {k, unbounded},
                                    [&](const FoundNeighbours& found) { queries += found.size; });
        EXPECT_EQ(queries, p.size());
        return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    };
    EXPECT_LT(seconds(narrow(1000000, [](std::size_t) { return Vec3i{1, 2, 3}; }), 16), 20);
    EXPECT_LT(seconds(narrow(100000, [](std::size_t i) { return Vec3i{std::int64_t(i), 0, 0}; }), 16), 5);
    for (const std::int64_t far : {1000000000ll, 1000000000000ll, 1ll << 61}) {
        InBox a(5000, 5000, 5000), b(5000, 5000, 5000);
        EXPECT_LT(seconds(wide(200000,
                               [&](std::size_t i) {
                                   Vec3i at = a();
                                   at[0] += i % 2 ? far : 0;
                                   return at;
                               }),
                          16),
                  10);
        EXPECT_LT(seconds(wide(200000, [&](std::size_t i) { return i ? b() : Vec3i{far, 0, 0}; }), 16), 10);
    }
    InBox strays(1ll << 45, 1ll << 45, 1ll << 45), cluster(5000, 5000, 5000);
    EXPECT_LT(seconds(wide(200000, [&](std::size_t i) { return i % 500 ? cluster() : strays(); }), 16), 5);
    EXPECT_LT(seconds(narrow(125000,
                             [](std::size_t i) {
                                 return on_lattice(i, 50, {10000019, 10000019, 10000019});
                             }),
                      16),
              5);
}

}  // namespace
}  // namespace pcm
