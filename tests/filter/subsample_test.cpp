#include "pcm/filter/subsample.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/update/append.h"
#include "pcm/update/compact.h"
#include "pcm/update/erase.h"

#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;

Schema some_types()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, {}});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, {}});
    schema.add({"gps_time", ScalarType::f64, 1, 1, 0, {}});
    return schema;
}

// Position and attributes as bytes.
std::vector<std::string> rows_of(const MemoryCloud& cloud)
{
    std::vector<std::string> rows;
    for (std::size_t i = 0; i < cloud.points.size; ++i) {
        const Vec3d p = position_of(cloud.points, cloud.info.grid, i);
        std::string row(reinterpret_cast<const char*>(p.data()), sizeof p);
        for (const Column& column : cloud.points.attributes) row += bytes_of(column, i);
        rows.push_back(row);
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

void expect_part(const MemoryCloud& whole, const MemoryCloud& part)
{
    const auto all = rows_of(whole), some = rows_of(part);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end())) << "points were changed or repeated";
    EXPECT_EQ(part.info.grid, whole.info.grid);
    EXPECT_EQ(part.info.position_type, whole.info.position_type);
}

double squared(const Vec3d& p, const Vec3d& q)
{
    const double dx = p[0] - q[0], dy = p[1] - q[1], dz = p[2] - q[2];
    return (dx * dx + dy * dy) + dz * dz;
}

std::vector<Vec3d> positions_of(const MemoryCloud& cloud)
{
    std::vector<Vec3d> positions;
    for (std::size_t i = 0; i < cloud.points.size; ++i)
        positions.push_back(position_of(cloud.points, cloud.info.grid, i));
    return positions;
}

// No two points nearer than the spacing, and every point of the cloud has one that is.
void expect_spacing(const MemoryCloud& whole, const MemoryCloud& part, double spacing)
{
    const std::vector<Vec3d> all = positions_of(whole), kept = positions_of(part);
    for (std::size_t i = 0; i < kept.size(); ++i)
        for (std::size_t j = i + 1; j < kept.size(); ++j) ASSERT_GE(squared(kept[i], kept[j]), spacing * spacing);
    for (const Vec3d& p : all)
        ASSERT_TRUE(
            std::any_of(kept.begin(), kept.end(), [&](const Vec3d& q) { return squared(p, q) < spacing * spacing; }));
}

class Subsample : public testing::Test {
protected:
    std::shared_ptr<const Tree> tree_of(const MemoryCloud& cloud, Sampling sampling = Sampling::poisson)
    {
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        options.overwrite = true;
        options.sampling = sampling;
        MemoryReader reader(cloud);
        build_tree(reader, {"memory"}, path(), options);
        return Tree::open(path());
    }
    std::filesystem::path path() const { return folder_ / "cloud.pct"; }
    static MemoryCloud read(std::unique_ptr<PointReader> reader) { return read_all(*reader, 777); }
    static MemoryCloud points_of(std::shared_ptr<const Tree> tree, std::optional<std::uint16_t> level = {})
    {
        return read(std::make_unique<TreeReader>(std::move(tree), level, Selection()));
    }
    TemporaryFolder folder_;
};

SubsampleOptions spacing_of(double spacing, bool exact = true)
{
    SubsampleOptions options;
    options.spacing = spacing;
    options.exact = exact;
    options.memory_bytes = 0;  // as many boxes as possible
    options.threads = 2;
    return options;
}

SubsampleOptions number_of(std::uint64_t points, bool exact)
{
    SubsampleOptions options;
    options.points = points;
    options.exact = exact;
    return options;
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Subsample, PCM_NOT_UNDER_THREAD(ExactSpacingOnCloudsOfAllKinds))
{
    struct Case {
        const char* name;
        std::optional<Grid> grid;
        double extent, spacing;
    };
    const Case cases[] = {
        {"on a grid", Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, 10, 1.1},
        {"map", Grid{{0.001, 0.001, 0.001}, {500000, 4800000, 100}}, 10, 1.7},
        {"nearly all", Grid{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 0}}, 100, 3},
        {"lattice of distances", Grid{{1, 1, 1}, {0, 0, 0}}, 10, 2},  // many distances are exactly the spacing
        {"one is left", Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, 1, 100},
        {"tiny", std::nullopt, 1e-6, 1e-7},
        {"huge", std::nullopt, 1e9, 1e8},
        {"huge, small spacing", std::nullopt, 1e9, 1e-3},
    };
    std::uint64_t seed = 1;
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        const auto tree = tree_of(random_cloud(some_types(), c.grid, 12000, ++seed, c.extent));
        const MemoryCloud whole = points_of(tree);
        const MemoryCloud part = read(open_subsample(tree, spacing_of(c.spacing)));
        expect_part(whole, part);
        expect_spacing(whole, part, c.spacing);
    }
}

TEST_F(Subsample, ExactSpacingOfATreeThatWasChanged)
{
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    tree_of(random_cloud(some_types(), grid, 9000, 20, 10), Sampling::grid);
    const MemoryCloud more = random_cloud(some_types(), grid, 5000, 21, 10);
    MemoryReader added(more);
    append_points(path(), added, {"more"});
    Selection corner;
    corner.box = Box3d{{0, 0, 0}, {10, 10, 10}};
    erase_points(path(), corner, {});
    const auto tree = Tree::open(path());
    const MemoryCloud whole = points_of(tree), part = read(open_subsample(tree, spacing_of(1.3)));
    expect_part(whole, part);
    expect_spacing(whole, part, 1.3);
}

TEST_F(Subsample, CoincidentPointsSinglePointsAndNone)
{
    for (const std::size_t count : {std::size_t(0), std::size_t(1), std::size_t(9000)}) {
        MemoryCloud cloud = random_cloud(some_types(), Grid{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 0}}, count, 3, 10);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::int32_t& q : cloud.points.grid_xyz[a]) q = 77;
        const auto tree = tree_of(cloud);
        for (const SubsampleOptions& options :
             {spacing_of(1), spacing_of(1, false), number_of(5, true), number_of(1, false)}) {
            const auto reader = open_subsample(tree, options);
            const MemoryCloud part = read_all(*reader);
            EXPECT_EQ(reader->fraction_read(), 1.0);
            expect_part(cloud, part);
            if (options.exact && options.spacing) EXPECT_EQ(part.points.size, std::min<std::size_t>(count, 1));
            if (options.exact && options.points) EXPECT_EQ(part.points.size, std::min<std::size_t>(count, 5));
        }
    }
}

TEST_F(Subsample, ThreadsDoNotChangeTheResult)
{
    const auto tree = tree_of(random_cloud(some_types(), std::nullopt, 20000, 5, 10));
    std::vector<std::string> first;
    for (const unsigned threads : {1u, 2u, 5u}) {
        SubsampleOptions options = spacing_of(0.7);
        options.threads = threads;
        const auto rows = rows_of(read(open_subsample(tree, options)));
        if (first.empty()) first = rows;
        EXPECT_TRUE(rows == first) << threads;
    }
}

TEST_F(Subsample, TheLevelNearestToASpacing)
{
    const auto tree = tree_of(random_cloud(some_types(), std::nullopt, 30000, 6, 10));
    const auto& spacings = tree->info().spacings;
    ASSERT_GE(spacings.size(), 3u);
    for (std::size_t k = 0; k + 1 < spacings.size(); ++k)
        for (const double factor : {0.72, 1.0, 1.4}) {
            const SubsampleOptions options = spacing_of(spacings[k] * factor, false);
            const ChosenLevel chosen = choose_level(*tree, options);
            EXPECT_EQ(chosen.level, k) << factor;
            EXPECT_EQ(chosen.spacing, spacings[k]);
            const MemoryCloud part = read(open_subsample(tree, options));
            EXPECT_EQ(part.points.size, chosen.points);
            EXPECT_TRUE(rows_of(part) == rows_of(points_of(tree, static_cast<std::uint16_t>(k))));
        }
    EXPECT_EQ(choose_level(*tree, spacing_of(1e9, false)).level, 0);
    const ChosenLevel all = choose_level(*tree, spacing_of(1e-9, false));
    EXPECT_EQ(all.spacing, 0);
    EXPECT_EQ(all.points, 30000u);
}

TEST_F(Subsample, PCM_NOT_UNDER_THREAD(ANumberOfPoints))
{
    const auto tree = tree_of(random_cloud(some_types(), std::nullopt, 30000, 7, 10));
    const MemoryCloud whole = points_of(tree);
    const auto levels = tree->level_summaries();
    for (const std::uint64_t points :
         {std::uint64_t(1), std::uint64_t(50), levels[0].points_to_here, levels[0].points_to_here + 1,
          levels[1].points_to_here + 1000, std::uint64_t(29999), std::uint64_t(30000), std::uint64_t(99999)}) {
        const auto reader = open_subsample(tree, number_of(points, true));
        const std::uint64_t promised = reader->info().points;
        const MemoryCloud part = read_all(*reader, 333);
        EXPECT_EQ(part.points.size, std::min<std::uint64_t>(points, 30000));
        EXPECT_EQ(promised, part.points.size);
        expect_part(whole, part);
        const ChosenLevel level = choose_level(*tree, number_of(points, false));
        EXPECT_EQ(level.points, read(open_subsample(tree, number_of(points, false))).points.size);
        if (points >= levels[0].points_to_here) {
            EXPECT_LE(level.points, points);
            // All points of the level, and the rest from everywhere.
            const auto coarse = rows_of(points_of(tree, level.level)), some = rows_of(part);
            EXPECT_TRUE(std::includes(some.begin(), some.end(), coarse.begin(), coarse.end()));
        }
    }
    // Evenly: half of the points on either side.
    const MemoryCloud part = read(open_subsample(tree, number_of(levels[1].points_to_here + 1000, true)));
    const auto below =
        std::count_if(part.points.xyz[0].begin(), part.points.xyz[0].end(), [](double x) { return x < 0; });
    EXPECT_NEAR(static_cast<double>(below) / static_cast<double>(part.points.size), 0.5, 0.05);
}

TEST_F(Subsample, SaysWhatLevelsDoNotPromise)
{
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    const MemoryCloud cloud = random_cloud(some_types(), grid, 9000, 20, 10);
    EXPECT_EQ(level_caveat(*tree_of(cloud)), "");
    EXPECT_NE(level_caveat(*tree_of(cloud, Sampling::grid)).find("fast build"), std::string::npos);
    tree_of(cloud);
    MemoryReader more(cloud);
    append_points(path(), more, {"more"});
    EXPECT_NE(level_caveat(*Tree::open(path())).find("appended"), std::string::npos);
    Selection corner;
    corner.box = Box3d{{0, 0, 0}, {10, 10, 10}};
    erase_points(path(), corner, {});
    EXPECT_NE(level_caveat(*Tree::open(path())).find("deleted"), std::string::npos);
    ResultOptions to;
    to.target.copy = folder_ / "part.pct";
    to.memory_bytes = 128 << 20;
    SubsampleReport report = subsample(path(), spacing_of(1, false), to);
    EXPECT_NE(report.caveat.find("deleted"), std::string::npos);
    ASSERT_TRUE(report.level);
    EXPECT_EQ(report.level->points, report.build.outcome.points_out);
    EXPECT_EQ(report.build.outcome.points_in, Tree::open(path())->info().points);
    to.target.overwrite = true;
    report = subsample(path(), spacing_of(1), to);
    EXPECT_EQ(report.caveat, "");
    EXPECT_FALSE(report.level);
    compact_tree(path());
    EXPECT_EQ(level_caveat(*Tree::open(path())), "");
}

TEST_F(Subsample, RefusesWishesThatMakeNoSense)
{
    const auto tree = tree_of(random_cloud({}, std::nullopt, 100, 7, 1e9));
    SubsampleOptions both = spacing_of(1), none;
    both.points = 7;
    for (const SubsampleOptions& options :
         {both, none, spacing_of(0), spacing_of(-1), spacing_of(std::nan("")), spacing_of(HUGE_VAL), spacing_of(1e-200),
          spacing_of(1e-7), number_of(0, true), spacing_of(0, false), number_of(0, false)})
        try {
            open_subsample(tree, options);
            ADD_FAILURE() << "accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        }
}

}  // namespace
