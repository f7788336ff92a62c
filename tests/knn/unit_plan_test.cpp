#include "pcm/knn/unit_plan.h"

#include "pcm/build/builder.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pcm::test {
namespace {

double uniform(std::mt19937_64& random) { return double(random() >> 11) * 0x1p-53; }

template <class Shape>
std::shared_ptr<const Tree> tree_of(const TemporaryFolder& folder, std::size_t count, const Shape& shape)
{
    MemoryCloud cloud = random_cloud(Schema(), std::nullopt, count, 1, 1);
    std::mt19937_64 random(1);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d p = shape(random, i);
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = p[a];
    }
    MemoryReader reader(cloud);
    BuildOptions build;
    build.chunk_points = 1000;
    build.overwrite = true;
    build_tree(reader, {"memory"}, folder.path() / "cloud.pct", build);
    return Tree::open(folder.path() / "cloud.pct");
}

// Numbers of points in each unit, after every point was found in exactly one.
std::vector<std::uint64_t> points_in(const Tree& tree, const std::vector<Box3i>& units)
{
    std::vector<std::uint64_t> points(units.size());
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        const Chunk chunk = tree.read_chunk(id, ColumnSet::only_positions());
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            const Vec3i p = chunk.positions->grid(i);
            std::size_t holding = 0;
            for (std::size_t u = 0; u < units.size(); ++u)
                if (units[u].contains(p)) {
                    ++points[u];
                    ++holding;
                }
            EXPECT_EQ(holding, 1u);
        }
    }
    return points;
}

TEST(PlanUnits, DividesASurfaceAboutEvenly)
{
    const TemporaryFolder folder;
    const auto tree = tree_of(folder, 60000, [](std::mt19937_64& random, std::size_t) {
        return Vec3d{100 * uniform(random), 100 * uniform(random), uniform(random)};
    });
    const auto units = plan_units(*tree, 5000);
    const auto points = points_in(*tree, units);
    EXPECT_GE(units.size(), 12u);
    EXPECT_LE(units.size(), 24u);
    EXPECT_LE(*std::max_element(points.begin(), points.end()), 7500u);
}

TEST(PlanUnits, HoldsEachPointOfStiffCloudsOnce)
{
    const TemporaryFolder folder;
    const auto stiff = [](std::mt19937_64& random, std::size_t i) {
        if (i % 1000 == 3) return Vec3d{1e9 * uniform(random), -1e9 * uniform(random), 0};
        if (i % 3 == 0) return Vec3d{7, 7, 7};  // a third at one place
        return Vec3d{uniform(random), i % 2 ? 0 : 10 * uniform(random), 0};
    };
    const auto tree = tree_of(folder, 30000, stiff);
    const auto units = plan_units(*tree, 2000);
    const auto points = points_in(*tree, units);
    EXPECT_GE(*std::max_element(points.begin(), points.end()), 9900u);  // at one place
    std::uint64_t crowded = 0;
    for (const std::uint64_t p : points) crowded += p > 6000;
    EXPECT_EQ(crowded, 1u);
}

TEST(PlanUnits, NeedsNoUnitForNothingAndOneForOnePlace)
{
    const TemporaryFolder folder;
    const auto one_place = [](std::mt19937_64&, std::size_t) { return Vec3d{1, 2, 3}; };
    EXPECT_TRUE(plan_units(*tree_of(folder, 0, one_place), 1000).empty());
    EXPECT_EQ(plan_units(*tree_of(folder, 1, one_place), 1000).size(), 1u);
    EXPECT_EQ(plan_units(*tree_of(folder, 5000, one_place), 1000).size(), 1u);
}

// Coordinates may have steps of different lengths: the longest side is that of the cloud, not the one of most steps.
TEST(PlanUnits, CutsAcrossTheLongestSideInSourceUnits)
{
    const TemporaryFolder folder;
    for (std::size_t longest = 0; longest < 3; ++longest) {
        // Along one axis 100 units in steps of 0.05, along the others 40 in steps of 0.001.
        Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        grid.scale[longest] = 0.05;
        MemoryCloud cloud = random_cloud(Schema(), grid, 20000, 5, 20);
        for (auto& at : cloud.points.grid_xyz[longest]) at = at * 5 / 2;
        MemoryReader reader(cloud);
        BuildOptions build;
        build.chunk_points = 1000;
        build.overwrite = true;
        build_tree(reader, {"memory"}, folder.path() / "steps.pct", build);
        const auto tree = Tree::open(folder.path() / "steps.pct");
        const auto units = plan_units(*tree, 12000);
        ASSERT_EQ(units.size(), 2u);
        points_in(*tree, units);
        for (std::size_t a = 0; a < 3; ++a)
            EXPECT_EQ(units[0].max[a] < units[1].min[a] || units[1].max[a] < units[0].min[a], a == longest) << a;
    }
}

TEST(PlanUnits, EstimatesTheNumberOfPointsInABox)
{
    const TemporaryFolder folder;
    const auto tree = tree_of(folder, 60000, [](std::mt19937_64& random, std::size_t) {
        return Vec3d{100 * uniform(random), 100 * uniform(random), 0};
    });
    Box3i box = tree->info().box;
    EXPECT_EQ(estimated_points(*tree, box), 60000);
    box.max[0] = (box.min[0] + box.max[0]) / 2;
    EXPECT_NEAR(estimated_points(*tree, box), 30000, 1500);
    box.max[1] = box.min[1] + (box.max[1] - box.min[1]) / 10;
    EXPECT_NEAR(estimated_points(*tree, box), 3000, 600);
}

}  // namespace
}  // namespace pcm::test
