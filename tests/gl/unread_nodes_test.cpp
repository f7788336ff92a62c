// Pictures of a tree whose nodes come while it is drawn.
#include "tests/gl/gl_support.h"
#include "tests/tree/small_tree.h"

#include <algorithm>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int wide = 160, high = 120;
constexpr std::uint32_t nodes_a_page = 8;

struct DrawnPages {
    FrameReport first, last;
    std::vector<Pixel> pixels;
};

class UnreadNodesOfPictures : public testing::Test {
protected:
    void write_pages(std::uint32_t nodes) const { write_in_pages(folder_ / "cube.pct", nodes); }
    std::filesystem::path path() const { return folder_ / "cube.pct" / index_file_name; }
    test::TemporaryFolder folder_;
};

DrawnPages draw_all(const std::shared_ptr<PointCloud>& cloud, const Camera& view, const RenderOptions& options)
{
    const Framebuffer framebuffer(wide, high);
    Drawing drawing(cloud);
    DrawnPages picture;
    framebuffer.clear();
    picture.first = drawing.draw(view, map_offset, options);
    picture.last = draw_until_done(drawing, framebuffer, view, map_offset, options);
    picture.pixels = framebuffer.read();
    drawing.release();
    return picture;
}

}  // namespace

TEST_F(UnreadNodesOfPictures, TheFirstFrameReadsNoneAndTheLastHasAll)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    make_cloud(folder_, "cube", grid_at(map_offset), random_points(100000, 10000, 21), 1000);
    const Camera view = view_of(overview(10), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);
    for (const double target : {1.4, 40.0})  // the nodes in view are read for the moving view, or for the resting one
        for (const bool converge : {true, false}) {
            RenderOptions options = everything();
            options.target_spacing_px = target;
            options.converge = converge;
            write_pages(1000);
            const DrawnPages whole = draw_all(PointCloud::open(folder_ / "cube.pct"), view, options);
            write_pages(nodes_a_page);
            const auto cloud = PointCloud::open(folder_ / "cube.pct");
            ASSERT_EQ(cloud->tree()->nodes().pages_loaded(), 1u);
            const DrawnPages paged = draw_all(cloud, view, options);
            EXPECT_LE(paged.first.nodes_wanted, nodes_a_page);
            if (target < 2) {
                EXPECT_GT(whole.first.nodes_wanted, nodes_a_page);
                EXPECT_TRUE(paged.first.refining);
                EXPECT_GT(paged.first.screen_error_px, options.target_spacing_px);
            }
            EXPECT_EQ(paged.last.error, "");
            EXPECT_EQ(paged.last.points_drawn, whole.last.points_drawn);
            EXPECT_EQ(paged.last.nodes_drawn, whole.last.nodes_drawn);
            EXPECT_EQ(paged.last.full_resolution, whole.last.full_resolution);
            // Nodes below the target may stay unread, and count with their parents' boxes.
            EXPECT_GE(paged.last.screen_error_px, whole.last.screen_error_px);
            EXPECT_LE(paged.last.screen_error_px, std::max(target, whole.last.screen_error_px));
            if (converge) EXPECT_TRUE(paged.last.full_resolution);
            EXPECT_TRUE(paged.pixels == whole.pixels) << target << " " << converge;
        }
}

TEST_F(UnreadNodesOfPictures, APageThatCannotBeReadIsReportedAndTheRestIsShown)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    make_cloud(folder_, "cube", grid_at(map_offset), random_points(100000, 10000, 21), 1000);
    write_pages(nodes_a_page);
    std::vector<std::byte> bytes = read_file(path());
    bytes[bytes.size() - 40] ^= std::byte{1};  // in the last page
    write_file(path(), bytes);
    const Camera view = view_of(overview(10), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);
    const Framebuffer framebuffer(wide, high);
    Drawing drawing(PointCloud::open(folder_ / "cube.pct"));
    FrameReport report;
    for (int frame = 0; frame < 5000; ++frame) {
        framebuffer.clear();
        report = drawing.draw(view, map_offset, everything());
        if (!report.error.empty() && !report.refining) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_FALSE(report.refining);
    EXPECT_FALSE(report.full_resolution);
    EXPECT_GT(report.retry_seconds, 0);
    EXPECT_NE(report.error.find("index"), std::string::npos) << report.error;
    EXPECT_GT(report.screen_error_px, 0);
    const NodeTable& nodes = drawing.drawn.cloud()->tree()->nodes();
    EXPECT_EQ(nodes.find(static_cast<NodeId>(nodes.size() - 1)), nullptr);
    EXPECT_GT(report.points_drawn, 0u);
    EXPECT_LT(report.points_drawn, 100000u);
    drawing.release();
}
