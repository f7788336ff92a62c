#include "pcm/build/levels/level_sampler.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/system/error.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <random>

namespace pcm {
namespace {

template <class Coord>
using Cloud = std::vector<Point<Coord>>;

// A cloud cut into bins along random planes, sorted, and sampled.
template <class Coord>
struct Sampled {
    Cloud<Coord> points;
    std::vector<std::uint8_t> levels;
    std::vector<double> spacings;
};

template <class Coord>
std::vector<Cloud<Coord>> cut(Cloud<Coord> cloud, std::size_t most)
{
    if (cloud.size() <= most) return {cloud};
    std::size_t axis = 0;
    Coord widest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto [low, high] =
            std::minmax_element(cloud.begin(), cloud.end(), [&](const auto& p, const auto& q) { return p[a] < q[a]; });
        if ((*high)[a] - (*low)[a] > widest) {
            widest = (*high)[a] - (*low)[a];
            axis = a;
        }
    }
    if (widest == 0) return {cloud};
    std::nth_element(cloud.begin(), cloud.begin() + static_cast<std::ptrdiff_t>(cloud.size() / 2), cloud.end(),
                     [&](const auto& p, const auto& q) { return p[axis] < q[axis]; });
    const Coord at = cloud[cloud.size() / 2][axis];
    Cloud<Coord> low, high;
    for (const auto& p : cloud) (p[axis] < at ? low : high).push_back(p);
    if (low.empty()) return {high};
    auto bins = cut(low, most);
    for (auto& bin : cut(high, most)) bins.push_back(bin);
    return bins;
}

// With `given`, as an addition to that.
template <class Coord>
Sampled<Coord> sample(const Cloud<Coord>& cloud, const Lattice& lattice, std::size_t most, unsigned threads,
                      Sampling sampling = Sampling::poisson, const Sampled<Coord>* given = nullptr)
{
    const test::TemporaryFolder folder;
    const auto bins = cut(cloud, most);
    SortedPoints<Coord> store(folder.path() / "points");
    store.resize(bins.size() + 1);  // and one without points
    RowLayout layout;
    layout.coordinate_bytes = sizeof(Coord);
    layout.bytes = 3 * sizeof(Coord);
    Sampled<Coord> result;
    std::vector<Cloud<Coord>> sorted;
    for (std::size_t b = 0; b < bins.size(); ++b) {
        const auto order = morton_order<Coord>(reinterpret_cast<const std::byte*>(bins[b].data()), bins[b].size(),
                                               layout, lattice.finer);
        Cloud<Coord> points;
        for (const std::uint32_t i : order) points.push_back(bins[b][i]);
        for (std::size_t i = 1; i < points.size(); ++i)
            EXPECT_FALSE(morton_before(points[i], points[i - 1], lattice.finer));
        store.put(b, points);
        sorted.push_back(points);
    }
    LevelSampler<Coord> sampler(store, lattice, sampling, folder.path() / "chosen");
    if (given) {
        GivenLevels<Coord> levels;
        levels.spacings = given->spacings;
        levels.list = [given](const Point<Coord>& low, const Point<Coord>& high, std::size_t first, std::size_t last,
                              const typename GivenLevels<Coord>::Visit& visit) {
            for (std::size_t i = 0; i < given->points.size(); ++i) {
                const Point<Coord>& p = given->points[i];
                bool inside = given->levels[i] >= first && given->levels[i] <= last;
                for (std::size_t a = 0; a < 3; ++a) inside = inside && p[a] >= low[a] && p[a] <= high[a];
                if (inside) visit(&p, 1);
            }
        };
        sampler.add_to(std::move(levels));
    }
    sampler.run(threads, [](double) {});
    result.spacings = sampler.spacings();
    for (std::size_t b = 0; b < bins.size(); ++b) {
        const auto levels = sampler.levels(b);
        std::vector<std::uint64_t> histogram(result.spacings.size(), 0);
        for (const std::uint8_t level : levels) ++histogram.at(level);
        EXPECT_EQ(histogram, sampler.histogram(b));
        result.points.insert(result.points.end(), sorted[b].begin(), sorted[b].end());
        result.levels.insert(result.levels.end(), levels.begin(), levels.end());
    }
    return result;
}

// By brute force: no two points of a level's cloud nearer than its spacing, no point as far from all of them.
template <class Coord>
void expect_maximal_poisson(const Sampled<Coord>& cloud, const Lattice& lattice)
{
    Vec3d squared_scale;
    for (std::size_t a = 0; a < 3; ++a) squared_scale[a] = lattice.scale[a] * lattice.scale[a];
    for (std::size_t level = 0; level < cloud.spacings.size(); ++level) {
        const double squared = cloud.spacings[level] * cloud.spacings[level];
        if (level > 0) {
            ASSERT_LT(cloud.spacings[level], cloud.spacings[level - 1]);
        }
        if (squared == 0) {
            ASSERT_EQ(level + 1, cloud.spacings.size());
            break;
        }
        Cloud<Coord> chosen;
        for (std::size_t i = 0; i < cloud.points.size(); ++i)
            if (cloud.levels[i] <= level) chosen.push_back(cloud.points[i]);
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < chosen.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                nearest = std::min(nearest, squared_distance(chosen[i], chosen[j], squared_scale));
        ASSERT_GE(nearest, squared) << "level " << level;
        double farthest = 0;
        for (const auto& p : cloud.points) {
            double d = std::numeric_limits<double>::infinity();
            for (const auto& q : chosen) d = std::min(d, squared_distance(p, q, squared_scale));
            farthest = std::max(farthest, d);
        }
        ASSERT_LT(farthest, squared) << "level " << level;
    }
}

// What level_sampler.h says of a cloud and one that was added to it.
template <class Coord>
void expect_added_levels(const Sampled<Coord>& given, const Sampled<Coord>& added, const Lattice& lattice)
{
    ASSERT_GE(added.spacings.size(), given.spacings.size());
    ASSERT_LE(added.spacings.size(), given.spacings.size() + (given.spacings.back() > 0 ? 1 : 0));
    Vec3d squared_scale;
    for (std::size_t a = 0; a < 3; ++a) squared_scale[a] = lattice.scale[a] * lattice.scale[a];
    const auto squared = [&](std::size_t level) { return added.spacings[level] * added.spacings[level]; };
    // How far from added points their nearest of each level are; from given ones they are known to be near enough.
    for (std::size_t i = 0; i < added.points.size(); ++i) {
        std::vector<double> nearest(added.spacings.size(), std::numeric_limits<double>::infinity());
        std::size_t barred = 0;  // levels before this
        const auto see = [&](const Point<Coord>& q, std::size_t level, bool was_given) {
            const double d = squared_distance(added.points[i], q, squared_scale);
            nearest[level] = std::min(nearest[level], d);
            ASSERT_GE(d, squared(std::max<std::size_t>(level, added.levels[i])));
            if (was_given && d < squared(level)) barred = std::max(barred, level + 1);
        };
        for (std::size_t n = 0; n < given.points.size(); ++n) see(given.points[n], given.levels[n], true);
        for (std::size_t n = 0; n < added.points.size(); ++n)
            if (n != i) see(added.points[n], added.levels[n], false);
        nearest[added.levels[i]] = 0;
        ASSERT_GE(added.levels[i], barred);
        double d = std::numeric_limits<double>::infinity();
        for (std::size_t level = 0; level < nearest.size() && squared(level) > 0; ++level) {
            d = std::min(d, nearest[level]);
            ASSERT_LT(d, squared(level) * (level < barred ? 2.25 : 1.0));
        }
    }
}

template <class Coord>
class Levels : public testing::Test {
public:
    static constexpr Coord middle = std::numeric_limits<Coord>::max() / 2 + 1;
    std::mt19937_64 random{12345};
    Coord near_middle(std::uint64_t reach) { return static_cast<Coord>(middle - reach / 2 + random() % (reach + 1)); }

    Cloud<Coord> cloud(const std::string& kind, std::size_t count)
    {
        Cloud<Coord> points(count);
        for (std::size_t i = 0; i < count; ++i) {
            Point<Coord>& p = points[i];
            if (kind == "volume") p = {near_middle(30000), near_middle(30000), near_middle(30000)};
            if (kind == "plane") p = {near_middle(500000), near_middle(500000), static_cast<Coord>(middle + 7)};
            if (kind == "line") p = {near_middle(1u << 30), middle, middle};
            if (kind == "duplicates") p = {near_middle(9), near_middle(9), near_middle(1)};
            if (kind == "point") p = {5, 6, 7};
            if (kind == "clusters") {
                const std::uint64_t far = std::numeric_limits<Coord>::max() / 4;
                const std::uint64_t where = random() % 5;
                p = {static_cast<Coord>(middle - far + where * (far / 3) + random() % 40),
                     static_cast<Coord>(middle + (where * where % 3) * (far / 2) + random() % 40),
                     static_cast<Coord>(middle + random() % 40)};
            }
            if (kind == "uneven") {  // from crowded to sparse
                const double u = static_cast<double>(random() % 1000000) / 1e6;
                p = {static_cast<Coord>(middle + static_cast<Coord>(1e6 * u * u * u * u)), near_middle(3000), middle};
            }
        }
        return points;
    }
};
using Widths = testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(Levels, Widths);

TYPED_TEST(Levels, AreMaximalPoissonSamples)
{
    // Bins of 4 points are more than lists of neighbours hold at coarse spacings.
    for (const std::string kind : {"volume", "plane", "line", "duplicates", "point", "clusters", "uneven"})
        for (const std::size_t most : {100000u, 300u, 40u, 4u}) {
            SCOPED_TRACE(kind + ", bins of " + std::to_string(most));
            const Lattice lattice(Grid{{0.001, 0.001, 0.001}, {0, 0, 0}});
            const auto sampled = sample<TypeParam>(this->cloud(kind, 1500), lattice, most, 2);
            expect_maximal_poisson(sampled, lattice);
            if (this->HasFatalFailure()) return;
        }
}

TYPED_TEST(Levels, OfSeveralSpacings)
{
    for (const std::string kind : {"plane", "line"}) {
        SCOPED_TRACE(kind);
        const Lattice lattice(Grid{{0.001, 0.0008, 0.001}, {0, 0, 0}});
        const auto sampled = sample<TypeParam>(this->cloud(kind, 9000), lattice, 1000, 2);
        EXPECT_GE(sampled.spacings.size(), 3u);
        expect_maximal_poisson(sampled, lattice);
        if (this->HasFatalFailure()) return;
    }
}

// Bins that are a little less than a spacing apart, of one point and of a few: what one chooses matters to the next.
// Under no sanitizer: minutes there, in one thread, of what other tests run too.
PCM_TYPED_TEST(Levels, PCM_NOT_UNDER_SANITIZERS(OfBinsThatAreAlmostASpacingApart))
{
    const Lattice lattice(Grid{{0.001, 0.001, 0.001}, {0, 0, 0}});
    for (const double share : {0.9996, 0.9999, 1.0})
        for (const std::size_t most : {1u, 3u}) {
            SCOPED_TRACE(std::to_string(share) + ", bins of " + std::to_string(most));
            const int size = 20;  // a million steps
            const auto gap = static_cast<TypeParam>(share * lattice.spacing(size) / 0.001);
            Cloud<TypeParam> cloud;
            for (TypeParam i = 0; i < 1500; ++i) cloud.push_back({static_cast<TypeParam>(i * gap), this->middle, 5});
            // A pile, so that sampling continues until most points of the line are chosen.
            cloud.insert(cloud.end(), 600, {static_cast<TypeParam>(1510 * gap), this->middle, 5});
            const auto sampled = sample<TypeParam>(cloud, lattice, most, 2);
            expect_maximal_poisson(sampled, lattice);
            if (this->HasFatalFailure()) return;
            bool met = false;
            for (const double spacing : sampled.spacings)
                met = met || (0.001 * double(gap) <= spacing && 0.001 * double(gap) >= 0.9995 * spacing);
            if (most == 1) EXPECT_TRUE(met);  // bins of more begin with finer levels
        }
}

// Levels of an interrupted build: one level, of one point or of points at one place, and several.
TYPED_TEST(Levels, AreLoadedAsTheyWereSaved)
{
    const Lattice lattice(Grid{{0.001, 0.001, 0.001}, {0, 0, 0}});
    RowLayout layout;
    layout.coordinate_bytes = sizeof(TypeParam);
    layout.bytes = 3 * sizeof(TypeParam);
    for (const auto& [kind, count] :
         {std::pair<const char*, std::size_t>{"point", 1}, {"volume", 1}, {"volume", 9}, {"plane", 4000}}) {
        SCOPED_TRACE(std::string(kind) + " of " + std::to_string(count));
        const test::TemporaryFolder folder;
        const Cloud<TypeParam> cloud = this->cloud(kind, count);
        SortedPoints<TypeParam> store(folder.path() / "points");
        store.resize(1);
        Cloud<TypeParam> points;
        for (const std::uint32_t i : morton_order<TypeParam>(reinterpret_cast<const std::byte*>(cloud.data()),
                                                             cloud.size(), layout, lattice.finer))
            points.push_back(cloud[i]);
        store.put(0, points);
        using Sampler = LevelSampler<TypeParam>;
        Sampler saved(store, lattice, Sampling::poisson, folder.path() / "chosen", File::Mode::create_or_truncate);
        saved.run(1, [](double) {});
        ByteWriter out;
        saved.save(out);
        saved.sync();
        Sampler loaded(store, lattice, Sampling::poisson, folder.path() / "chosen", File::Mode::read);
        const std::filesystem::path name = folder.path() / "record";
        const std::vector<std::byte>& record = out.bytes();
        ByteReader in(record.data(), record.size(), name);
        loaded.load(in);
        EXPECT_EQ(loaded.spacings(), saved.spacings());
        EXPECT_EQ(loaded.histogram(0), saved.histogram(0));
        EXPECT_EQ(loaded.levels(0), saved.levels(0));
        EXPECT_EQ(loaded.levels(0).size(), count);
    }
}

TYPED_TEST(Levels, OfAnisotropicGrids)
{
    for (const Vec3d scale : {Vec3d{1e-8, 1e-8, 1.7664e-9}, Vec3d{0.01, 0.01, 0.3048}, Vec3d{1, 0.25, 1.0 / 64}}) {
        const Lattice lattice(Grid{scale, {0, 0, 0}});
        const auto sampled = sample<TypeParam>(this->cloud("volume", 1200), lattice, 200, 2);
        expect_maximal_poisson(sampled, lattice);
        if (this->HasFatalFailure()) return;
    }
}

// Not under the thread sanitizer: all of it runs in one thread.
PCM_TYPED_TEST(Levels, PCM_NOT_UNDER_THREAD(OfAddedPointsFitTheGivenOnes))
{
    for (const std::string kind : {"volume", "plane", "line", "duplicates", "point", "clusters", "uneven"})
        for (const std::size_t count : {500u, 60u}) {
            SCOPED_TRACE(kind + ", " + std::to_string(count) + " added");
            const Lattice lattice(Grid{{0.001, 0.001, 0.0006}, {0, 0, 0}});
            const auto given = sample<TypeParam>(this->cloud(kind, 7000), lattice, 2000, 2);
            const auto cloud = this->cloud(kind, count);
            const auto added = sample<TypeParam>(cloud, lattice, 300, 2, Sampling::poisson, &given);
            expect_added_levels(given, added, lattice);
            if (this->HasFatalFailure()) return;
            const auto again = sample<TypeParam>(cloud, lattice, 300, 7, Sampling::poisson, &given);
            EXPECT_EQ(added.levels, again.levels);
        }
}

// A cell of a level has one point of the levels up to it, and it has one where either cloud has any.
TYPED_TEST(Levels, OfPointsAddedByGrid)
{
    for (const std::string kind : {"volume", "plane", "line", "duplicates", "clusters", "uneven"})
        for (const std::size_t count : {3000u, 100u}) {
            SCOPED_TRACE(kind + ", " + std::to_string(count) + " added");
            const Lattice lattice(Grid{{0.001, 0.001, 0.0006}, {0, 0, 0}});
            const auto given = sample<TypeParam>(this->cloud(kind, 3100 - count), lattice, 100000, 1, Sampling::grid);
            const auto added = sample<TypeParam>(this->cloud(kind, count), lattice, 100000, 1, Sampling::grid, &given);
            for (std::size_t level = 0; level < added.spacings.size() && added.spacings[level] > 0; ++level) {
                const auto shifts = lattice.shifts(std::ilogb(added.spacings[level] / lattice.spacing(0) * 1.000001));
                std::map<Point<TypeParam>, std::size_t> cells;
                for (const auto* cloud : {&given, &added})
                    for (std::size_t i = 0; i < cloud->points.size(); ++i) {
                        Point<TypeParam> cell = cloud->points[i];
                        for (std::size_t a = 0; a < 3; ++a)
                            cell[a] = static_cast<TypeParam>(std::uint64_t(cell[a]) >> shifts[a]);
                        cells[cell] += cloud->levels[i] <= level;
                    }
                for (const auto& cell : cells) ASSERT_EQ(cell.second, 1u);
            }
        }
}

TYPED_TEST(Levels, AreAddedToALadderOfTheGridAlone)
{
    const Lattice lattice(Grid{{0.001, 0.001, 0.001}, {0, 0, 0}});
    auto given = sample<TypeParam>(this->cloud("plane", 3000), lattice, 3000, 1);
    const auto good = given.spacings;
    const auto refused = [&](std::vector<double> spacings) {
        given.spacings = std::move(spacings);
        EXPECT_THROW(sample<TypeParam>({{1, 2, 3}}, lattice, 10, 1, Sampling::poisson, &given), Error);
    };
    refused({});
    refused({0});
    refused({-good[0]});
    refused({good[0] * 1.5});
    refused({good[0], good[0]});
    refused({good[0], good[0] / 4});
    refused({lattice.spacing(0) / 2});
    refused({std::numeric_limits<double>::infinity()});
    refused({std::numeric_limits<double>::quiet_NaN()});
}

TYPED_TEST(Levels, DoNotDependOnThreads)
{
    const Lattice lattice(Grid{{0.001, 0.001, 0.001}, {0, 0, 0}});
    for (const Sampling sampling : {Sampling::poisson, Sampling::grid}) {
        const auto cloud = this->cloud("plane", 20000);
        const auto one = sample<TypeParam>(cloud, lattice, 1500, 1, sampling);
        for (const unsigned threads : {2u, 7u}) {
            const auto more = sample<TypeParam>(cloud, lattice, 1500, threads, sampling);
            EXPECT_EQ(one.points, more.points);
            EXPECT_EQ(one.levels, more.levels);
            EXPECT_EQ(one.spacings, more.spacings);
        }
    }
}

TYPED_TEST(Levels, GrowFourfoldOnASurface)
{
    const Lattice lattice(Grid{{0.001, 0.001, 0.001}, {0, 0, 0}});
    for (const Sampling sampling : {Sampling::poisson, Sampling::grid}) {
        const auto sampled = sample<TypeParam>(this->cloud("plane", 40000), lattice, 5000, 2, sampling);
        std::vector<std::size_t> counts(sampled.spacings.size(), 0);
        for (const std::uint8_t level : sampled.levels)
            for (std::size_t k = level; k < counts.size(); ++k) ++counts[k];
        EXPECT_GE(counts[0], 512u);
        EXPECT_GE(counts.size(), 3u);
        for (std::size_t k = 1; k < counts.size(); ++k) {
            // The rest is at most ten times what is chosen.
            EXPECT_LT(counts[k], (sampled.spacings[k] > 0 ? 5 : 10.5) * static_cast<double>(counts[k - 1]));
            if (sampled.spacings[k] > 0) {
                EXPECT_GT(counts[k], 2 * counts[k - 1]);
            }
        }
    }
}

}  // namespace
}  // namespace pcm
