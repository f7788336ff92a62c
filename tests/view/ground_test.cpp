// The ground under places against brute force over the points in memory.
#include "pcm/view/ground.h"

#include "pcm/build/builder.h"
#include "pcm/cloud/vector.h"
#include "pcm/point_cloud.h"
#include "tests/memory_reader.h"
#include "tests/support.h"
#include "tests/tree/small_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

class GroundTest : public testing::Test {
protected:
    // A slope of 1 in 5, and above it trees: a third of the points up to 20 higher. A few lie far below.
    void SetUp() override
    {
        Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        grid.offset = {512345, 4812345, 100};
        MemoryCloud cloud = random_cloud({}, grid, 20000, 3, 200);
        std::mt19937_64 random(4);
        for (std::size_t i = 0; i < cloud.points.size; ++i) {
            const double x = cloud.points.grid_xyz[0][i] * 0.001;
            const double tree = random() % 3 ? 0 : 0.001 * static_cast<double>(random() % 20000);
            const double below = random() % 100 ? 0 : -30;
            cloud.points.grid_xyz[2][i] = static_cast<std::int32_t>((x / 5 + tree + below) * 1000);
        }
        BuildOptions options;
        options.chunk_points = 1000;
        MemoryReader reader(cloud);
        build_tree(reader, {"memory"}, folder_ / "t.pct", options);
        cloud_ = PointCloud::open(folder_ / "t.pct");
    }
    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
};

TEST_F(GroundTest, IsTheSixthLowestOfTheNearestInMemory)
{
    read_again_in_pages(folder_ / "t.pct", cloud_);
    L2Cache& cache = cloud_->cache();
    const Tree& tree = cache.tree();
    EXPECT_FALSE(ground_under(cache, tree.info().bounds().centre(), 2));  // nothing is in memory, and nothing is read
    std::mt19937_64 random(5);
    int found = 0;
    for (const double share : {0.1, 0.5, 1.0}) {
        cache.clear();
        std::vector<Vec3d> points;
        for (NodeId id = 0; id < tree.nodes().size() * share; ++id) {
            if (tree.node(id).points == 0) continue;
            const auto chunk = cache.get(id, ColumnSet::only_positions());
            for (std::size_t i = 0; i < chunk->points; ++i)
                points.push_back(tree.info().grid.to_source(chunk->positions->grid(i)));
        }
        const std::size_t pages = tree.nodes().pages_loaded();
        if (share < 1) EXPECT_LT(pages, tree.nodes().pages());
        const Box3d box = tree.info().bounds();
        for (int round = 0; round < 100; ++round) {
            const std::size_t axis = round % 4 == 3 ? 1 : 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
            Vec3d place;
            for (std::size_t a = 0; a < 3; ++a)
                place[a] = box.min[a] + box.extent(a) * static_cast<double>(random() % 1001) / 1000;
            place[axis] += 100;  // has no effect
            std::vector<std::pair<double, double>> all;
            for (const Vec3d& p : points) all.emplace_back(std::hypot(p[u] - place[u], p[v] - place[v]), p[axis]);
            const auto ground = ground_under(cache, place, axis);
            ASSERT_EQ(ground.has_value(), all.size() >= 24);
            if (!ground) continue;
            std::nth_element(all.begin(), all.begin() + 23, all.end());
            all.resize(24);
            const double farthest = std::max_element(all.begin(), all.end())->first;
            std::vector<double> heights;
            for (const auto& each : all) heights.push_back(each.second);
            std::sort(heights.begin(), heights.end());
            EXPECT_NEAR(ground->height, heights[5], 1e-6);
            EXPECT_NEAR(ground->spacing, farthest * std::sqrt(pi / 24), 1e-6);
            if (axis == 2 && share == 1) {
                const double slope = 100 + (place[0] - 512345) / 5;
                EXPECT_NEAR(ground->height, slope, 3);
                ++found;
            }
        }
        EXPECT_EQ(tree.nodes().pages_loaded(), pages) << "nodes were read";
    }
    EXPECT_GT(found, 50);
}

TEST_F(GroundTest, NothingBesideTheCloud)
{
    L2Cache& cache = cloud_->cache();
    for (NodeId id = 0; id < cache.tree().nodes().size(); ++id) cache.get(id, ColumnSet::only_positions());
    const Box3d box = cache.tree().info().bounds();
    EXPECT_TRUE(ground_under(cache, box.centre(), 2));
    EXPECT_FALSE(ground_under(cache, {box.max[0] + 0.01, box.centre()[1], 0}, 2));
    EXPECT_FALSE(ground_under(cache, {std::nan(""), box.centre()[1], 0}, 2));
    EXPECT_FALSE(ground_under(cache, box.centre(), 3));
    GroundLimits none;
    none.points = 100;
    EXPECT_FALSE(ground_under(cache, box.centre(), 2, none));
}

}  // namespace
