// Which points are measured at which level. What is measured of them: tests/build/build_test.cpp.

#include "pcm/tree/verify_levels.h"

#include "pcm/cloud/numbers.h"
#include "pcm/cloud/vector.h"
#include "tests/tree/small_tree.h"

namespace {

using namespace pcm;
using namespace pcm::test;

using VerifyLevelsTest = SmallTree;

// A cloud with a dense spot, so that some nodes have points of one level and some of several.
TEST_F(VerifyLevelsTest, EveryPointCountsAtItsLevelAndAtFinerOnes)
{
    std::vector<LasRecord> points = records(Shape::surface, 60000, 3);
    for (std::size_t i = 0; i < 50000; ++i) {
        points[i].x /= 30;
        points[i].y /= 30;
        points[i].z /= 30;
    }
    write_las(folder_ / "in.las", points, {});
    BuildOptions options;
    options.chunk_points = 1000;
    build_tree({folder_ / "in.las"}, this->tree(), options);
    const auto tree = Tree::open(this->tree());
    std::size_t single = 0, several = 0;
    std::vector<std::uint64_t> to_level(tree->info().levels, 0);
    for (const Node& node : tree->nodes()) {
        single += node.level_points.size() == 1;
        several += node.level_points.size() > 1;
        for (std::size_t level = 0; level < to_level.size(); ++level) to_level[level] += node.points_to_level(level);
    }
    ASSERT_GT(single, 0u);
    ASSERT_GT(several, 0u);

    for (const unsigned threads : {1u, 3u}) {
        const LevelsReport report = verify_levels(*tree, threads);
        EXPECT_TRUE(report.faults.empty()) << report.faults.front();
        ASSERT_EQ(report.levels.size(), to_level.size() - 1);  // the last one has spacing 0
        ASSERT_GE(report.levels.size(), 2u);
        for (std::size_t level = 0; level < report.levels.size(); ++level) {
            const LevelMeasure& measure = report.levels[level];
            EXPECT_EQ(measure.points, to_level[level]) << level;
            EXPECT_LE(measure.isolated, measure.points) << level;
            EXPECT_GE(measure.least_distance, 1) << level;
            EXPECT_GT(measure.coverage, 0.5) << level;
            EXPECT_LT(measure.coverage, 1) << level;
        }
    }
}

struct LevelPoint {
    Vec3d place{};
    std::size_t level = 0;
};

std::vector<LevelPoint> level_points(const Tree& tree)
{
    std::vector<LevelPoint> points;
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        const Node& node = tree.node(id);
        const Chunk chunk = tree.read_chunk(id, ColumnSet::only_positions());
        std::uint32_t i = 0;
        for (std::size_t run = 0; run < node.level_points.size(); ++run)
            for (std::uint32_t k = 0; k < node.level_points[run]; ++k, ++i)
                points.push_back({tree.info().grid.to_source(chunk.positions->grid(i)), node.first_level + run});
    }
    return points;
}

// From every pair of points.
LevelMeasure measured_by_pairs(const std::vector<LevelPoint>& points, std::size_t level, double spacing)
{
    LevelMeasure measure;
    double least = infinity, farthest = 0, sum = 0, squares = 0, near = 0;
    std::vector<const LevelPoint*> chosen;
    for (const LevelPoint& p : points)
        if (p.level <= level) chosen.push_back(&p);
    for (const LevelPoint& p : points) {
        double nearest = infinity;
        for (const LevelPoint* const other : chosen)
            if (&p != other) nearest = std::min(nearest, length(p.place - other->place) / spacing);
        if (p.level > level) {
            farthest = std::max(farthest, nearest > 2 ? infinity : nearest);
            continue;
        }
        ++measure.points;
        least = std::min(least, nearest);
        if (nearest > 2) {
            ++measure.isolated;
            continue;
        }
        ++near;
        sum += nearest;
        squares += nearest * nearest;
    }
    measure.least_distance = least;
    measure.coverage = farthest;
    if (near > 0) measure.variation = std::sqrt(std::max(0.0, squares / near - std::pow(sum / near, 2))) / (sum / near);
    return measure;
}

// A cloud is measured in tiles of any number of points: no point is left out, and neighbours in other tiles count.
TEST_F(VerifyLevelsTest, TilesAreMeasuredAsAllPairsOfPoints)
{
    // More than half of the points lie on a wall at the end of the longest axis: there are tiles whose points cannot be
    // halved in the middle. A few lie far from all others.
    std::vector<LasRecord> points = records(Shape::surface, 3000, 5);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 8 < 5) points[i].x = 150000;
        if (i % 500 == 0) points[i].z += 100 * static_cast<std::int32_t>(i);
    }
    write_las(folder_ / "in.las", points, {});
    for (const Sampling sampling : {Sampling::poisson, Sampling::grid}) {
        BuildOptions options;
        options.chunk_points = 1000;
        options.sampling = sampling;
        options.overwrite = true;
        build_tree({folder_ / "in.las"}, this->tree(), options);
        const auto tree = Tree::open(this->tree());
        const std::vector<LevelPoint> all = level_points(*tree);
        const LevelsReport whole = verify_levels(*tree, 1);
        ASSERT_GE(whole.levels.size(), 1u);
        std::uint64_t isolated = 0;
        for (std::size_t level = 0; level < whole.levels.size(); ++level) {
            const LevelMeasure &a = whole.levels[level], b = measured_by_pairs(all, level, a.spacing);
            EXPECT_EQ(a.points, b.points) << level;
            EXPECT_EQ(a.isolated, b.isolated) << level;
            EXPECT_NEAR(a.least_distance, b.least_distance, 1e-9) << level;
            EXPECT_NEAR(a.coverage, b.coverage, 1e-9) << level;
            EXPECT_NEAR(a.variation, b.variation, 1e-9) << level;
            isolated += a.isolated;
        }
        EXPECT_GT(isolated, 0u);
        for (const std::size_t tile_points : {12u, 200u})
            for (const unsigned threads : {1u, 3u}) {
                SCOPED_TRACE(testing::Message() << tile_points << " " << threads);
                const LevelsReport tiles = verify_levels(*tree, threads, {}, tile_points);
                EXPECT_EQ(tiles.faults, whole.faults);
                ASSERT_EQ(tiles.levels.size(), whole.levels.size());
                for (std::size_t level = 0; level < whole.levels.size(); ++level) {
                    const LevelMeasure &a = tiles.levels[level], &b = whole.levels[level];
                    EXPECT_EQ(a.points, b.points) << level;
                    EXPECT_EQ(a.isolated, b.isolated) << level;
                    EXPECT_EQ(a.least_distance, b.least_distance) << level;
                    EXPECT_EQ(a.coverage, b.coverage) << level;
                    EXPECT_NEAR(a.variation, b.variation, 1e-9) << level;
                }
            }
    }
}

}  // namespace
