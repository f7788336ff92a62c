// The spacing at a place, on clouds whose spacing is known.

#include "pcm/query/local_spacing.h"

#include "pcm/build/builder.h"
#include "pcm/point_cloud.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

class LocalSpacing : public testing::Test {
protected:
    // At full double places.
    std::shared_ptr<PointCloud> cloud_of(const std::vector<Vec3d>& places)
    {
        MemoryCloud cloud = random_cloud({}, std::nullopt, places.size(), 1);
        for (std::size_t i = 0; i < places.size(); ++i)
            for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = places[i][a];
        BuildOptions options;
        options.chunk_points = 1000;
        options.overwrite = true;
        MemoryReader reader(cloud);
        build_tree(reader, {"memory"}, folder_ / "cloud.pct", options);
        return PointCloud::open(folder_ / "cloud.pct");
    }
    TemporaryFolder folder_;
};

// A lattice of 0.5 on the left and 2 on the right, each point doubled, and one that stands alone.
TEST_F(LocalSpacing, OfTheSurfaceAndNotOfOnePoint)
{
    std::vector<Vec3d> places;
    for (int copy = 0; copy < 2; ++copy) {
        for (int x = 0; x < 40; ++x)
            for (int y = 0; y < 40; ++y) places.push_back({0.5 * x - 20, 0.5 * y, 0});
        for (int x = 1; x < 11; ++x)
            for (int y = 0; y < 11; ++y) places.push_back({2.0 * x, 2.0 * y, 0});
    }
    places.push_back({-10, 10, 3});
    const auto cloud = cloud_of(places);
    EXPECT_NEAR(local_spacing(cloud->cache(), {-10, 10, 0}), 0.5, 1e-3);
    EXPECT_NEAR(local_spacing(cloud->cache(), {-10, 10, 3}), 0.5, 1e-3);  // at the one that stands alone
    EXPECT_NEAR(local_spacing(cloud->cache(), {12, 10, 0}), 2, 1e-3);
}

TEST_F(LocalSpacing, OfFewPoints)
{
    EXPECT_EQ(local_spacing(cloud_of({{1, 2, 3}})->cache(), {0, 0, 0}), 0);
    EXPECT_EQ(local_spacing(cloud_of({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}})->cache(), {0, 0, 0}), 0);
    EXPECT_NEAR(local_spacing(cloud_of({{1, 2, 3}, {1, 2, 5}})->cache(), {0, 0, 0}), 2, 1e-6);
}

}  // namespace
