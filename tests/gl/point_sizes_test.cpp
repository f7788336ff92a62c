// Sizes of points as radii of splats.
#include "pcm/view/point_sizes.h"

#include "pcm/build/builder.h"
#include "pcm/tree/point_size.h"
#include "tests/gl/gl_support.h"
#include "tests/memory_reader.h"

#include <algorithm>
#include <limits>

using namespace pcm;
using namespace pcm::test;

namespace {

Column codes_of(const std::vector<std::uint8_t>& codes)
{
    Column column(attribute_of_sizes());
    column.resize(codes.size());
    std::copy(codes.begin(), codes.end(), column.as<std::uint8_t>());
    return column;
}

// The radii of points of a node that have none of their own.
std::vector<float> radii_of(const Tree& tree, NodeId node, const std::vector<std::uint8_t>& codes)
{
    std::vector<float> radii(codes.size(), 0.0f);
    PointSizes(tree).fill_in(node, codes_of(codes), radii);
    return radii;
}

}  // namespace

TEST(PointSizes, FillInWhereAPointHasNoRadius)
{
    const TemporaryFolder folder;
    const auto cloud =
        make_cloud(folder, "sheet", grid_at(map_offset), sheet(100, [](std::int32_t) { return 0; }), 1000);
    const Tree& tree = *cloud->tree();
    const double least = least_point_size(tree.info().grid);
    std::vector<float> radii{0, 3, 0, 1e30f, 1e-9f};
    PointSizes(tree).fill_in(0, codes_of({20, 20, 31, 40, 50}), radii);
    EXPECT_FLOAT_EQ(radii[0], static_cast<float>(point_size(20, least)));
    EXPECT_EQ(radii[1], 3);
    EXPECT_FLOAT_EQ(radii[2], static_cast<float>(point_size(31, least)));
    EXPECT_EQ(radii[3], 1e30f);
    EXPECT_EQ(radii[4], 1e-9f);
}

TEST(PointSizes, AreAtMostATwentiethOfTheCloud)
{
    const TemporaryFolder folder;
    // 9.9 x 9.9 x 0 units; another axis is the largest in the second cloud.
    auto points = sheet(100, [](std::int32_t) { return 0; });
    for (const double extent : {9.9, 19.8}) {
        if (extent > 10) points[17].z = -19800;
        const auto cloud = make_cloud(folder, "sheet" + std::to_string(extent), grid_at(map_offset), points, 1000);
        std::vector<std::uint8_t> all(255);
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i + 1);
        const std::vector<float> radii = radii_of(*cloud->tree(), 0, all);
        EXPECT_FLOAT_EQ(*std::max_element(radii.begin(), radii.end()), static_cast<float>(extent / 20));
        EXPECT_TRUE(std::is_sorted(radii.begin(), radii.end()));
        EXPECT_LT(radii[0], 0.001f);
    }
}

// Chunks without sizes, of trees that were built before sizes were kept.
TEST(PointSizes, WithoutThemTheSpacingBelowCounts)
{
    const TemporaryFolder folder;
    // A fine sheet, and a coarse one next to it.
    auto points = sheet(200, [](std::int32_t) { return 0; });
    for (LasPoint p : sheet(40, [](std::int32_t) { return 0; })) {
        p.x = 8 * p.x + 30000;
        p.y *= 8;
        points.push_back(p);
    }
    for (const std::uint32_t chunk_points : {1000u, 100000u}) {
        const auto cloud =
            make_cloud(folder, "two" + std::to_string(chunk_points), grid_at(map_offset), points, chunk_points);
        const Tree& tree = *cloud->tree();
        const NodeTable& nodes = tree.nodes();
        std::vector<double> unknown;
        for (NodeId id = 0; id < nodes.size(); ++id) {
            const std::vector<float> radii = radii_of(tree, id, {0, 20, 0});
            EXPECT_EQ(radii[0], radii[2]);
            EXPECT_FLOAT_EQ(radii[1], static_cast<float>(point_size(20, least_point_size(tree.info().grid))));
            unknown.push_back(static_cast<double>(radii[0]));
        }
        for (NodeId id = 0; id < nodes.size(); ++id) {
            double below = 0;
            for (const NodeId child : nodes[id].children)
                if (child != no_node) below = std::max(below, unknown[child]);
            if (below > 0) {
                EXPECT_EQ(unknown[id], below) << id;
                continue;
            }
            // A leaf: no less than the distance of its points, and a few times as much at most.
            const double x = tree.info().grid.to_source(nodes[id].box.min)[0] - map_offset[0];
            EXPECT_GT(unknown[id], x < 25 ? 0.05 : 0.4) << id;
            EXPECT_LT(unknown[id], chunk_points > 1000 || x > 25 ? 1.7 : 0.4) << id;
        }
    }
}

// In a picture: the radius of a point that has one, the size of one that has none, and of one in a tree without sizes.
TEST(PointSizes, ARadiusCountsBeforeASize)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    Schema schema;
    schema.add({"radius", ScalarType::f32});
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    const auto covered_by_last = [&](float radius) {
        MemoryCloud cloud = random_cloud(schema, grid, 1601, 1);
        for (std::int32_t i = 0; i < 1601; ++i) {
            const auto k = static_cast<std::size_t>(i);
            cloud.points.grid_xyz[0][k] = i < 1600 ? 1000 * (i % 40) : 55000;  // the last one stands alone
            cloud.points.grid_xyz[1][k] = i < 1600 ? 1000 * (i / 40) : 20000;
            cloud.points.grid_xyz[2][k] = 0;
            cloud.points.attributes[0].as<float>()[k] = i < 1600 ? 0 : radius;
        }
        MemoryReader reader(cloud);
        BuildOptions build;
        build.overwrite = true;
        build_tree(reader, {"radii"}, folder / "radii.pct", build);
        Drawing drawing(PointCloud::open(folder / "radii.pct"));
        drawing.style.splats = SplatMode::adaptive;
        RenderOptions options = everything();
        options.converge = false;
        const Framebuffer framebuffer(240, 160);  // four pixels a unit
        const Camera view = view_of(translation(-30, -20, 0), orthographic(30, 20, -10, 10), 240, 160);
        draw_until_done(drawing, framebuffer, view, {0, 0, 0}, options);
        const auto pixels = framebuffer.read();
        drawing.release();
        std::size_t rest = 0, last = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i)
            if (pixels[i].a) ++(i % 240 >= 170 ? last : rest);
        // The others, one unit apart: a closed surface, a little larger than it is.
        EXPECT_GE(rest, 156u * 156);
        EXPECT_LE(rest, 170u * 165);
        return last;
    };
    EXPECT_EQ(covered_by_last(4), 32u * 32);  // also beyond a twentieth of the cloud
    EXPECT_EQ(covered_by_last(0.25f), 2u * 2);
    // Its size is that of its surroundings, one and a half times 1 to 1.42 units, rounded up, and not its distance
    // of 16.
    const std::size_t of_its_own = covered_by_last(0);
    EXPECT_GE(of_its_own, 8u * 8);
    EXPECT_LE(of_its_own, 21u * 21);
}
