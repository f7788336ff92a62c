#include "plugin/scene/proxy.h"

#include "plugin/scene/origin.h"
#include "tests/plugin/scenes.h"

#include <algorithm>

namespace pcm::host {
namespace {

TEST(Proxy, IsBoundedAndSpansTheTrueBox)
{
    const test::TemporaryFolder folder;
    const auto cloud = PointCloud::open(tree_of(scene(folder, "a.las", 150000, far_away)));
    const Box3d bounds = cloud->info().bounds();
    const Vec3d origin = choose_origin(bounds);
    for (const std::uint64_t most : {100u, 5000u, 50000u}) {
        const Proxy proxy = make_proxy(*cloud, origin, most);
        EXPECT_LE(proxy.points.size(), most + 6);
        EXPECT_GE(proxy.points.size(), most / 4);
        EXPECT_TRUE(proxy.has_rgb);
        Box3d box;
        for (const ProxyPoint& point : proxy.points)
            box.extend(Vec3d{point.position[0], point.position[1], point.position[2]});
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_EQ(box.min[a], static_cast<float>(bounds.min[a] - origin[a]));
            EXPECT_EQ(box.max[a], static_cast<float>(bounds.max[a] - origin[a]));
        }
    }
}

TEST(Proxy, HasExactlyThePointsOfASmallCloud)
{
    const test::TemporaryFolder folder;
    const auto cloud = PointCloud::open(tree_of(scene(folder, "a.las", 10126, far_away)));
    const Proxy proxy = make_proxy(*cloud, choose_origin(cloud->info().bounds()));
    EXPECT_EQ(proxy.points.size(), 10126u);
    EXPECT_TRUE(proxy.is_whole);
}

TEST(Proxy, HasEachExtremePointOnce)
{
    const test::TemporaryFolder folder;
    const auto cloud = PointCloud::open(tree_of(scene(folder, "a.las", 60000, far_away)));
    const Vec3d origin = choose_origin(cloud->info().bounds());
    for (const std::uint64_t most : {1u, 100u, 5000u, 50000u}) {
        const Proxy proxy = make_proxy(*cloud, origin, most);
        EXPECT_FALSE(proxy.is_whole);
        for (const Vec3i& extreme : cloud->info().extremes) {
            const Vec3d p = cloud->info().grid.to_source(extreme);
            std::array<float, 3> local{};
            for (std::size_t a = 0; a < 3; ++a) local[a] = static_cast<float>(p[a] - origin[a]);
            EXPECT_EQ(std::count_if(proxy.points.begin(), proxy.points.end(),
                                    [&](const ProxyPoint& point) { return point.position == local; }),
                      1)
                << most;
        }
    }
}

TEST(Proxy, ColoursAreEightOrSixteenBitsOrIntensity)
{
    const test::TemporaryFolder folder;
    const auto first = [&](const std::string& name, std::uint16_t red, std::uint16_t step) {
        const auto cloud = PointCloud::open(tree_of(write_las(folder / name, 3000, red, step)));
        return make_proxy(*cloud, {0, 0, 0});
    };
    const Proxy eight = first("eight.las", 200, 1), sixteen = first("sixteen.las", 200 * 257, 1),
                none = first("none.las", 0, 7);
    EXPECT_EQ(eight.points[0].colour[0], 200);
    EXPECT_EQ(sixteen.points[0].colour[0], 200);
    EXPECT_TRUE(eight.has_rgb);
    // Black everywhere does not count as colour: the intensity shows.
    EXPECT_FALSE(none.has_rgb);
    int brightest = 0;
    for (const ProxyPoint& point : none.points) {
        EXPECT_EQ(point.colour[0], point.colour[1]);
        brightest = std::max<int>(brightest, point.colour[0]);
    }
    EXPECT_EQ(brightest, 255);
}

}  // namespace
}  // namespace pcm::host
