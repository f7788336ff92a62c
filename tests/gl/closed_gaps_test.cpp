// Pixels that no splat covers within a surface are filled; openings, and what is seen between leaves, are not.
#include "tests/gl/gl_support.h"

#include <cmath>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int size = 200;

struct Seen {
    std::vector<Pixel> pixels;
    std::vector<float> depths;
    const Pixel& at(int x, int y) const { return pixels[static_cast<std::size_t>(y * size + x)]; }
    float depth(int x, int y) const { return depths[static_cast<std::size_t>(y * size + x)]; }
    // Share of the pixels no farther than `reach` from the middle that show the cloud.
    double covered(int reach) const
    {
        int count = 0;
        for (int y = size / 2 - reach; y < size / 2 + reach; ++y)
            for (int x = size / 2 - reach; x < size / 2 + reach; ++x) count += at(x, y).a > 0;
        return count / (4.0 * reach * reach);
    }
};

struct Look {
    bool close = true;
    double radius_scale = 1;
    unsigned samples = 1, smooth_frames = 1;
    float eye_dome = 0;
    SplatMode splats = SplatMode::fitted;
};

Seen seen(const std::shared_ptr<PointCloud>& cloud, const Camera& view, const Look& look)
{
    const Framebuffer framebuffer(size, size);
    Drawing drawing(cloud);
    drawing.style = CloudStyle();
    drawing.style.splats = look.splats;
    drawing.style.colour = ColourMode::uniform;
    drawing.style.uniform_colour = {1, 1, 1};
    drawing.style.radius_scale = static_cast<float>(look.radius_scale);
    RenderOptions options = everything();
    options.fill_gaps = look.close;
    options.samples = look.samples;
    options.eye_dome = look.eye_dome;
    options.smooth_frames = look.smooth_frames;
    draw_until_done(drawing, framebuffer, view, {0, 0, 0}, options);
    Seen picture{framebuffer.read(), std::vector<float>(static_cast<std::size_t>(size * size))};
    glReadPixels(0, 0, size, size, GL_DEPTH_COMPONENT, GL_FLOAT, picture.depths.data());
    drawing.release();
    return picture;
}

// A plane of 20 units, of 80,000 points at random places, through the origin.
std::vector<LasPoint> plane_points()
{
    auto points = random_points(80000, 20000, 5);
    for (LasPoint& p : points) p.x -= 10000, p.y -= 10000, p.z = 0;
    return points;
}

struct View {
    Camera camera;
    double tilt, distance, half;
    bool parallel;
    // Depth in the window of the plane's point that pixel row y shows.
    double depth_of_row(int y) const
    {
        const Matrix& p = camera.projection;
        const double ndc = 2 * (y + 0.5) / size - 1, k = std::tan(tilt);
        const double z = parallel ? -distance + -ndc * half * k : -distance / (1 - k * ndc * half / distance);
        return ((p[10] * z + p[14]) / (p[11] * z + p[15]) + 1) / 2;
    }
};

View view_at(double degrees, double distance, bool parallel)
{
    View view{{}, degrees * 3.14159265358979 / 180, distance, 0.2 * distance, parallel};
    Matrix modelview = rotation_x(-view.tilt);
    modelview[14] = -distance;
    const double half = view.half;
    view.camera = view_of(
        modelview, parallel ? orthographic(half, half, 1, 100) : perspective(2 * std::atan(half / distance), 1, 1, 100),
        size, size);
    return view;
}

}  // namespace

TEST(ClosedGaps, ASurfaceHasNone)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "plane", grid_at({0, 0, 0}), plane_points());
    for (const double degrees : {0.0, 45.0, 65.0})
        for (const bool parallel : {false, true}) {
            const View view = view_at(degrees, 15, parallel);
            for (const Look& look :
                 {Look{true, 0.6}, Look{true, 0.6, 4}, Look{true, 0.6, 1, 8}, Look{true, 0.6, 1, 1, 1}}) {
                SCOPED_TRACE(testing::Message() << degrees << " degrees" << (parallel ? ", parallel, " : ", ")
                                                << look.samples << " samples, " << look.smooth_frames << " frames");
                Look open = look;
                open.close = false;
                const Seen closed = seen(cloud, view.camera, look), gaps = seen(cloud, view.camera, open);
                // The frames of a mean look into a gap from all sides.
                EXPECT_LT(gaps.covered(80), look.smooth_frames > 1 ? 1 : 0.9995);
                EXPECT_GT(closed.covered(80), 1 - 0.3 * (1 - gaps.covered(80)));
                // What fills a gap lies in the plane, within the depth of a few pixels.
                double worst = 0;
                for (int y = 20; y < 180; ++y)
                    for (int x = 20; x < 180; ++x)
                        if (closed.at(x, y).a == 255 && gaps.at(x, y).a == 0)
                            worst = std::max(worst,
                                             std::fabs(static_cast<double>(closed.depth(x, y)) - view.depth_of_row(y)));
                const double pixel = std::fabs(view.depth_of_row(100) - view.depth_of_row(101));
                EXPECT_LT(worst, 6 * pixel + (parallel ? 3.0 : 0.3) * 0.002);
            }
        }
}

TEST(ClosedGaps, OtherSplatsAreLeftAsTheyAre)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "plane", grid_at({0, 0, 0}), plane_points());
    const View view = view_at(0, 15, false);
    for (const SplatMode mode : {SplatMode::constant, SplatMode::adaptive}) {
        Look look{true, 0.7};
        look.splats = mode;
        Look open = look;
        open.close = false;
        EXPECT_EQ(seen(cloud, view.camera, look).pixels == seen(cloud, view.camera, open).pixels, true);
    }
}

// A window of 1 x 1 units, 13 pixels, and the plane's own edge.
TEST(ClosedGaps, OpeningsStayOpen)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = plane_points();
    points.erase(
        std::remove_if(points.begin(), points.end(),
                       [](const LasPoint& p) { return (std::abs(p.x) < 500 && std::abs(p.y) < 500) || p.x > 3000; }),
        points.end());
    const auto cloud = make_cloud(folder, "window", grid_at({0, 0, 0}), points);
    for (const bool parallel : {false, true}) {
        const View view = view_at(0, 15, parallel);
        const Seen closed = seen(cloud, view.camera, {true}), open = seen(cloud, view.camera, {false});
        for (int y = 96; y < 104; ++y)
            for (int x = 96; x < 104; ++x) EXPECT_EQ(closed.at(x, y).a, 0) << x << " " << y;
        int beside = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 202; x < size; ++x) beside += closed.at(x, y).a != open.at(x, y).a;
        EXPECT_EQ(beside, 0);
    }
}

// Between leaves one sees through.
TEST(ClosedGaps, LeavesAreNoSurface)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    std::vector<LasPoint> points = random_points(5000, 8000, 9);
    const auto cloud = make_cloud(folder, "leaves", grid_at({-4, -4, -4}), points);
    const Camera view = view_of(translation(0, 0, -25), perspective(0.3, 1, 1, 100), size, size);
    const double closed = seen(cloud, view, {true}).covered(80), open = seen(cloud, view, {false}).covered(80);
    EXPECT_LT(open, 0.9);
    EXPECT_LT(closed - open, 0.25 * (1 - open));
}
