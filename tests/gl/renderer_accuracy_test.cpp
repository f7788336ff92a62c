// Where points appear in the pictures of small trees, against projections in double precision.
#include "pcm/build/builder.h"
#include "tests/gl/gl_support.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

struct Window {
    double x, y, depth;  // depth in normalised device coordinates
    bool inside;
};

Window project(const Camera& camera, const Vec3d& local)
{
    const double v[4] = {local[0], local[1], local[2], 1};
    double eye[4] = {};
    double clip[4] = {};
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c) eye[r] += camera.modelview[c * 4 + r] * v[c];
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c) clip[r] += camera.projection[c * 4 + r] * eye[c];
    const bool inside = std::abs(clip[0]) <= clip[3] && std::abs(clip[1]) <= clip[3] && std::abs(clip[2]) <= clip[3];
    return {(clip[0] / clip[3] + 1) / 2 * camera.width, (clip[1] / clip[3] + 1) / 2 * camera.height, clip[2] / clip[3],
            inside};
}

}  // namespace

class RendererAccuracyIn : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, RendererAccuracyIn, testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) { return info.param == Profile::core ? "Core" : "Compatibility"; });

TEST_P(RendererAccuracyIn, ConstantSplatsCoverExactlyTheirSquares)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto points = random_points(2500, 10000, 1);
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), points, 1000);
    const Framebuffer framebuffer(320, 240);
    Drawing renderer(cloud);
    for (const Matrix& projection : {perspective(0.9, 4.0 / 3, 0.1, 1000), orthographic(8, 6, -100, 100)})
        for (const float size : {1.0f, 2.0f, 3.6f, 5.0f}) {
            const Camera camera = view_of(overview(10), projection, 320, 240);
            RenderOptions options = everything();
            renderer.style.point_size_px = size;
            const FrameReport report = draw_until_done(renderer, framebuffer, camera, map_offset, options);
            EXPECT_EQ(report.points_drawn, points.size());
            EXPECT_EQ(report.screen_error_px, 0);
            const auto pixels = framebuffer.read();

            // A pixel is covered when its centre lies in the square around a projected point. Rasterisers place points
            // on a subpixel raster (1/256 here; OpenGL requires 1/16): edges nearer than that are not tested.
            constexpr double slack = 1.0 / 128;
            std::vector<int> expected(320 * 240, 0);  // 0 dark, 1 either, 2 lit
            for (const LasPoint& p : points) {
                const Window w = project(camera, {p.x * 0.001, p.y * 0.001, p.z * 0.001});
                if (!w.inside) continue;  // its centre is outside: the whole splat is clipped
                for (int y = static_cast<int>(w.y - size); y <= static_cast<int>(w.y + size); ++y)
                    for (int x = static_cast<int>(w.x - size); x <= static_cast<int>(w.x + size); ++x) {
                        if (x < 0 || y < 0 || x >= 320 || y >= 240) continue;
                        const double away = std::max(std::abs(x + 0.5 - w.x), std::abs(y + 0.5 - w.y));
                        int& e = expected[static_cast<std::size_t>(y * 320 + x)];
                        e = std::max(e, away < size / 2.0 - slack ? 2 : away <= size / 2.0 + slack ? 1 : 0);
                    }
            }
            std::size_t wrong = 0;
            std::size_t sure = 0;
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                sure += expected[i] == 2;
                wrong += (expected[i] == 2 && pixels[i].r != 255) || (expected[i] == 0 && pixels[i].a != 0);
            }
            EXPECT_EQ(wrong, 0u) << "size " << size;
            EXPECT_GT(sure, 1000u);
        }
    renderer.release();
}

TEST_P(RendererAccuracyIn, MapCoordinatesDrawTheSamePicture)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto points = random_points(20000, 10000, 2);
    const Framebuffer framebuffer(320, 240);
    const Camera camera = view_of(overview(10), perspective(0.9, 4.0 / 3, 0.1, 1000), 320, 240);
    const RenderOptions options = everything();
    std::vector<std::vector<Pixel>> pictures;
    for (const Vec3d& offset : {Vec3d{0, 0, 0}, Vec3d{5000000, 5000000, 5000000}}) {
        Drawing renderer(
            make_cloud(folder, "at" + std::to_string(static_cast<int>(offset[0])), grid_at(offset), points));
        renderer.style.colour = ColourMode::rgb;
        draw_until_done(renderer, framebuffer, camera, offset, options);
        pictures.push_back(framebuffer.read());
        if (offset[0] > 0) {
            // Another local origin, as when several clouds share one: coordinates round to 1e-9 of the scene's metre,
            // so only a pixel whose centre a splat's edge nearly touches may change.
            const Vec3d other{offset[0] - 1234.567, offset[1] + 77.7, offset[2] + 3.3};
            const Camera moved = view_of(
                product(overview(10), translation(other[0] - offset[0], other[1] - offset[1], other[2] - offset[2])),
                perspective(0.9, 4.0 / 3, 0.1, 1000), 320, 240);
            draw_until_done(renderer, framebuffer, moved, other, options);
            const auto picture = framebuffer.read();
            std::size_t different = 0;
            for (std::size_t i = 0; i < picture.size(); ++i) different += !(picture[i] == pictures.back()[i]);
            EXPECT_LE(different, picture.size() / 1000);
        }
        renderer.release();
    }
    EXPECT_GT(count_lit(pictures[0]), 3000u);
    EXPECT_TRUE(pictures[0] == pictures[1]);
}

// Not under the address sanitizer: much drawing in software.
TEST(RendererAccuracy, PCM_NOT_UNDER_ADDRESS(ASlowPanDoesNotMakePointsTremble))
{
    // One point seen from 2 m, in a tile of 20 km at map coordinates, through a projection that magnifies the
    // surroundings of where it should appear 64 times: the lit pixel gives its place in the picture to 1/64 pixel. The
    // modelview, where the large numbers are, is the one of the plain picture.
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = random_points(400, 20000000, 3);
    for (const bool ortho : {false, true})
        for (const std::size_t which : {0u, 100u, 200u, 399u}) {
            const std::string name = std::to_string(ortho) + std::to_string(which);
            const auto cloud = make_cloud(folder, name, grid_at(map_offset), points);
            Drawing renderer(cloud);
            const int size = 512;
            const double zoom = 64;
            const Framebuffer framebuffer(size, size);
            RenderOptions options = everything();
            renderer.style.point_size_px = 1;
            const Vec3d local{points[which].x * 0.001, points[which].y * 0.001, points[which].z * 0.001};
            double least[2] = {1e9, 1e9};
            double most[2] = {-1e9, -1e9};
            for (int step = 0; step < 60; ++step) {
                const double aside = 0.3 + 0.0037 * step;
                const Matrix modelview =
                    product(rotation_x(-0.7), translation(-(local[0] + aside), -(local[1] - 1.4), -(local[2] + 1.5)));
                const Matrix plain = ortho ? orthographic(1.2, 1.2, -50, 50) : perspective(1.0, 1, 0.05, 1000);
                Camera camera = view_of(modelview, plain, 1000, 1000);
                const Window w = project(camera, local);
                ASSERT_TRUE(w.inside);
                // 8 pixels of the plain picture around w fill the 512 of this one.
                const double scale = 1000.0 / 8;
                const Matrix magnify{
                    scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, 1, 0, -(w.x / 500 - 1) * scale, -(w.y / 500 - 1) * scale,
                    0,     1};
                camera = view_of(modelview, product(magnify, plain), size, size);
                draw_until_done(renderer, framebuffer, camera, map_offset, options);
                const auto pixels = framebuffer.read();
                ASSERT_EQ(count_lit(pixels), 1u) << "step " << step;
                for (int i = 0; i < size * size; ++i)
                    if (pixels[static_cast<std::size_t>(i)].a) {
                        const double error[2] = {(i % size + 0.5 - size / 2) / zoom,
                                                 (i / size + 0.5 - size / 2) / zoom};
                        for (int a = 0; a < 2; ++a) {
                            least[a] = std::min(least[a], error[a]);
                            most[a] = std::max(most[a], error[a]);
                        }
                    }
            }
            for (int a = 0; a < 2; ++a) {
                EXPECT_LT(most[a] - least[a], 0.05) << "point " << which << " axis " << a;
                // The point itself is a float relative to its chunk: half an ulp of 20 km is 1 mm, seen from 2 m.
                EXPECT_LT(std::max(std::abs(least[a]), std::abs(most[a])), 1.0);
            }
            renderer.release();
        }
}

TEST(RendererAccuracy, DrawsWidePositions)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Vec3d> points(500);
    for (Vec3d& p : points) p = {unit(random), unit(random), unit(random)};
    {
        std::ofstream file(folder / "wide.ply");
        file << "ply\nformat ascii 1.0\nelement vertex 500\nproperty double x\nproperty double y\nproperty double "
                "z\nend_header\n"
             << std::setprecision(17);
        for (const Vec3d& p : points) file << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    }
    BuildOptions build;
    build.memory_bytes = std::uint64_t(128) << 20;
    build_tree({folder / "wide.ply"}, folder / "wide.pct", build);
    const auto cloud = PointCloud::open(folder / "wide.pct");
    EXPECT_TRUE(cloud->cache().get(0, ColumnSet::only_positions())->positions->wide);
    Drawing renderer(cloud);
    const Framebuffer framebuffer(200, 200);
    const Camera camera = view_of(translation(-0.5, -0.5, -2), perspective(0.7, 1, 0.1, 10), 200, 200);
    RenderOptions options = everything();
    renderer.style.colour = ColourMode::rgb;
    renderer.style.point_size_px = 3;
    const FrameReport report = draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
    EXPECT_EQ(report.clouds[0].style.colour, ColourMode::height);  // the cloud has neither colour nor intensity
    EXPECT_EQ(report.points_drawn, 500u);
    const auto pixels = framebuffer.read();
    for (const Vec3d& p : points) {
        const Window w = project(camera, p);
        if (w.inside) {
            EXPECT_GT(pixels[static_cast<std::size_t>(w.y) * 200 + static_cast<std::size_t>(w.x)].a, 0);
        }
    }
    renderer.release();
}
