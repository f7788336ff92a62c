// Tiles of snapshots, with projections made as MeshLab makes them.
#include "plugin/overlay/snapshot_tile.h"

#include "pcm/cloud/vector.h"
#include "pcm/view/screen_map.h"
#include "tests/plugin/cameras.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::host;

// glFrustum or glOrtho of part (column, row) of `times` by `times` parts of the view; in single precision, as OpenGL
// gives it back.
Camera part_of(bool parallel, int times, int column, int row)
{
    Camera camera = test::camera_at({500000, 4800000, 100}, parallel);
    constexpr double near = 0.5, far = 100, aspect = 800.0 / 600, fov = 60;
    const double top = parallel ? 1.75 : near * std::tan(fov * pi / 360);
    const double wide = 2 * top * aspect / times, high = 2 * top / times;
    const double left = -top * aspect + wide * column, bottom = -top + high * row;
    Matrix4d projection{};
    projection[0] = (parallel ? 2 : 2 * near) / wide;
    projection[5] = (parallel ? 2 : 2 * near) / high;
    projection[parallel ? 12 : 8] = (parallel ? -1 : 1) * (2 * left + wide) / wide;
    projection[parallel ? 13 : 9] = (parallel ? -1 : 1) * (2 * bottom + high) / high;
    projection[10] = parallel ? -2 / (far - near) : -(far + near) / (far - near);
    projection[14] = parallel ? -(far + near) / (far - near) : -2 * far * near / (far - near);
    projection[parallel ? 15 : 11] = parallel ? 1 : -1;
    for (double& number : projection) number = static_cast<float>(number);
    camera.projection = projection;
    return camera;
}

TEST(SnapshotTiles, AreWhereTheWholeSnapshotShowsTheSame)
{
    const Vec3d place{500000.4, 4800000.3, 100.2};
    for (const bool parallel : {false, true})
        for (const int times : {2, 3, 8})
            for (int column = 0; column < times; ++column)
                for (int row = 0; row < times; ++row) {
                    const Camera camera = part_of(parallel, times, column, row);
                    const SnapshotTile tile = tile_of(camera, parallel ? 5 : 60);
                    EXPECT_TRUE(tile.is_part());
                    EXPECT_EQ(tile.magnified, times);
                    EXPECT_EQ(tile.corner, QPoint(800 * column, 600 * row));
                    EXPECT_EQ(tile.whole.width, 800 * times);
                    EXPECT_EQ(tile.whole.height, 600 * times);
                    const auto in_tile = ScreenMap::of(camera)->place_of(place);
                    const auto in_whole = ScreenMap::of(tile.whole)->place_of(place);
                    ASSERT_TRUE(in_tile && in_whole);
                    EXPECT_NEAR((*in_tile)[0] + tile.corner.x(), (*in_whole)[0], 0.01);
                    EXPECT_NEAR((*in_tile)[1] + tile.corner.y(), (*in_whole)[1], 0.01);
                }
}

TEST(SnapshotTiles, TheViewItselfIsTheWhole)
{
    for (const bool parallel : {false, true}) {
        const Camera camera = part_of(parallel, 1, 0, 0);
        const SnapshotTile tile = tile_of(camera, parallel ? 5 : 60);
        EXPECT_FALSE(tile.is_part());
        EXPECT_EQ(tile.magnified, 1);
        EXPECT_EQ(tile.corner, QPoint(0, 0));
        EXPECT_EQ(tile.whole.projection, camera.projection);
        EXPECT_EQ(tile.whole.width, 800);
    }
}

}  // namespace
