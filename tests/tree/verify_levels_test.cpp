// Which points are measured at which level. What is measured of them: tests/build/build_test.cpp.

#include "pcm/tree/verify_levels.h"

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

}  // namespace
