// Selected points in a picture: which have the other colour, and what is uploaded when the selection changes.
#include "tests/gl/gl_support.h"

#include "pcm/cloud/condition.h"
#include "pcm/query/point_set.h"

#include <gtest/gtest.h>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int size = 96;

// From above, 12 units wide: a unit is 8 pixels, the cloud's corner is at pixel 8.
Camera from_above() { return view_of(translation(-5, -5, -30), orthographic(6, 6, 1, 100), size, size); }

std::vector<Pixel> picture_of(Drawing& drawing, const std::shared_ptr<const PointSet>& selected,
                              const std::vector<Clip>& clips = {})
{
    const Framebuffer framebuffer(size, size);
    SceneItem item;
    item.cloud = &drawing.drawn;
    item.origin = map_offset;
    item.style = drawing.style;
    item.selected = selected;
    item.selected_colour = {1, 0, 0};
    item.clips = clips;
    FrameReport report;
    for (int frame = 0; frame < 3000; ++frame) {
        framebuffer.clear();
        report = drawing.renderer.draw(drawing.picture, from_above(), {item}, everything());
        EXPECT_EQ(report.error, "");
        if (!report.refining || !report.error.empty()) break;
        if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(report.full_resolution);
    return framebuffer.read();
}

// The points whose x is in a range, relative to the map offset.
std::shared_ptr<PointSet> points_between(const std::shared_ptr<PointCloud>& cloud, double low, double high)
{
    auto set = std::make_shared<PointSet>(cloud->tree());
    const Tree& tree = *cloud->tree();
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        if (tree.nodes()[node].points == 0) continue;
        const L2Cache::Handle chunk = cloud->cache().get(node, ColumnSet{});
        std::vector<std::uint32_t> points;
        for (std::uint32_t i = 0; i < chunk->points; ++i) {
            const double x = tree.info().grid.to_source(chunk->positions->grid(i))[0] - map_offset[0];
            if (x >= low && x < high) points.push_back(i);
        }
        set->set(node, points);
    }
    return set;
}

bool is_red(const Pixel& p) { return p.a > 0 && p.r > 200 && p.g < 100; }
bool is_white(const Pixel& p) { return p.a > 0 && p.g > 200; }

// Pixels whose points have x in the range are red, the others white; not within a pixel and a splat of the borders.
void expect_red_between(const std::vector<Pixel>& pixels, double low, double high)
{
    std::size_t red = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const Pixel& p = pixels[static_cast<std::size_t>(y * size + x)];
            const double left = (x - 2 - 8) / 8.0, right = (x + 3 - 8) / 8.0;
            if (left >= low && right < high) {
                ASSERT_FALSE(is_white(p)) << x << " " << y;
                red += is_red(p);
            } else if (right < low || left >= high) {
                ASSERT_FALSE(is_red(p)) << x << " " << y;
            }
        }
    EXPECT_GT(red, 100u);
}

class SelectedPointsIn : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, SelectedPointsIn, testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) { return info.param == Profile::core ? "Core" : "Compatibility"; });

}  // namespace

TEST_P(SelectedPointsIn, HaveAnotherColourAtTheirOldPlace)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 4), 1000);
    const auto set = points_between(cloud, 3, 6.5);
    for (const SplatMode mode : {SplatMode::constant, SplatMode::adaptive}) {
        Drawing drawing(cloud);
        drawing.style.splats = mode;
        drawing.style.radius_scale = 0.5f;
        const auto plain = picture_of(drawing, nullptr), coloured = picture_of(drawing, set);
        if (mode == SplatMode::constant) expect_red_between(coloured, 3, 6.5);
        for (std::size_t i = 0; i < plain.size(); ++i) ASSERT_EQ(plain[i].a, coloured[i].a) << i;
        EXPECT_EQ(picture_of(drawing, nullptr), plain);
        EXPECT_EQ(picture_of(drawing, std::make_shared<PointSet>(cloud->tree())), plain);
        drawing.release();
    }
}

// A selection of all points also shows the points whose x is 0 in their chunk: its minimum.
TEST_P(SelectedPointsIn, AreAllOfThem)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "sheet", grid_at(map_offset), sheet(100, [](int) { return 0; }), 1000);
    Drawing drawing(cloud);
    const auto all = picture_of(drawing, std::make_shared<PointSet>(PointSet::all_of(cloud->tree())));
    std::size_t red = 0;
    for (const Pixel& p : all) {
        ASSERT_FALSE(is_white(p));
        red += is_red(p);
    }
    EXPECT_GT(red, 5000u);
    drawing.release();
}

// Conditions leave fewer points in video memory than the chunk has; clips and selections meet in one chunk.
TEST_P(SelectedPointsIn, AreRecognisedBehindConditionsAndClips)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 5), 1000);
    const auto set = points_between(cloud, 3, 6.5);
    Drawing drawing(cloud);
    drawing.style.where = {parse_condition("intensity >= 1500")};
    expect_red_between(picture_of(drawing, set), 3, 6.5);
    expect_red_between(
        picture_of(drawing, set, {{Region::box({map_offset + Vec3d{2, 2, 2}, map_offset + Vec3d{9, 9, 9}}), false}}), 3,
        6.5);
    drawing.release();
}

TEST_P(SelectedPointsIn, AreUploadedAgainOnlyWhereTheyChanged)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 6), 1000);
    Drawing drawing(cloud);
    const auto uploaded = [&] { return drawing.l1()->statistics().uploaded_bytes; };
    const auto first = points_between(cloud, 3, 6.5);
    picture_of(drawing, first);
    const std::uint64_t before = uploaded();
    picture_of(drawing, std::make_shared<PointSet>(*first));
    EXPECT_EQ(uploaded(), before) << "another set of the same points";
    const NodeId last = static_cast<NodeId>(cloud->tree()->nodes().size() - 1);
    auto more = std::make_shared<PointSet>(*first);
    more->set(last, first->count(last) == 1 ? std::vector<std::uint32_t>{0, 1} : std::vector<std::uint32_t>{0});
    picture_of(drawing, more);
    EXPECT_EQ(uploaded() - before, cloud->tree()->nodes()[last].points * 12u);
    drawing.release();
}

TEST_P(SelectedPointsIn, OfAnotherTreeAreNotShown)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(5000, 10000, 6), 1000);
    const auto other = make_cloud(folder, "other", grid_at(map_offset), random_points(9000, 10000, 7), 1000);
    Drawing drawing(cloud);
    const auto plain = picture_of(drawing, nullptr);
    EXPECT_EQ(picture_of(drawing, std::make_shared<PointSet>(PointSet::all_of(other->tree()))), plain);
    drawing.release();
}
