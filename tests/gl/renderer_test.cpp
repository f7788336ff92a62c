// Pictures of small trees against projections made here in double, and what the renderer promises to its host.
#include "tests/gl/gl_support.h"

#include "pcm/build/builder.h"
#include "pcm/tree/tree_index.h"
#include "pcm/view/level_of_detail.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <random>
#include <utility>

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

std::size_t count_lit(const std::vector<Pixel>& pixels)
{
    return static_cast<std::size_t>(
        std::count_if(pixels.begin(), pixels.end(), [](const Pixel& p) { return p.a > 0; }));
}

}  // namespace

class RendererIn : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, RendererIn, testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) { return info.param == Profile::core ? "Core" : "Compatibility"; });

// What a moving view comes to see is in RAM before; nothing of it when that is not asked for.
TEST_P(RendererIn, AMovingViewLoadsAhead)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud_file = make_cloud(folder, "cube", grid_at(map_offset), random_points(40000, 100000, 3), 1000);
    const Framebuffer framebuffer(320, 240);
    for (const bool ahead : {true, false}) {
        const auto cloud = PointCloud::open(cloud_file->tree()->folder());
        Drawing renderer(cloud);
        RenderOptions options = everything();
        options.prefetch_frames = ahead ? 8 : 0;
        const auto camera_at = [&](double x) {
            return view_of(product(translation(-x, -50, -160), translation(0, 0, 0)),
                           perspective(0.25, 4.0 / 3, 0.1, 1000), 320, 240);
        };
        draw_until_done(renderer, framebuffer, camera_at(20), map_offset, options);
        for (double x = 21; x <= 24; ++x) {
            for (int frame = 0; frame < 20; ++frame) {  // all of this view, and then what is ahead
                renderer.draw(camera_at(x + frame * 1e-9), map_offset, options);
                cloud->cache().wait_idle();
            }
            renderer.draw(camera_at(x + 0.5), map_offset, options);
            cloud->cache().wait_idle();
        }
        // Seen eight frames of half a metre from here.
        const Camera later = camera_at(24.5 + 8 * 0.5);
        Camera view = later;
        view.origin = map_offset;
        DetailLimits limits;
        limits.target_px = 0;
        std::size_t seen = 0, there = 0;
        for (const DetailNode& node : select_detail(*cloud->tree(), view, limits).wanted) {
            ++seen;
            there += static_cast<bool>(cloud->cache().find(node.node, ColumnSet::only_positions()));
        }
        EXPECT_GT(seen, 5u);
        if (ahead)
            EXPECT_EQ(there, seen);
        else
            EXPECT_LT(there, seen);
    }
}

TEST_P(RendererIn, ConstantSplatsCoverExactlyTheirSquares)
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
            // on a subpixel raster (1/256 here; 1/16 is what OpenGL asks for): edges nearer than that are left to them.
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

TEST_P(RendererIn, MapCoordinatesDrawTheSamePicture)
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
            // so only a pixel whose edge a splat all but touches may change.
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

TEST(Renderer, ASlowPanDoesNotMakePointsTremble)
{
    // One point seen from 2 m, in a tile of 20 km at map coordinates, through a projection that magnifies the
    // surroundings of where it should appear 64 times: the place of the lit pixel tells its place in the picture to
    // 1/64 pixel. The modelview, where the large numbers are, is the one of the plain picture.
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

TEST_P(RendererIn, LeavesTheStateOfTheHostAsItWas)
{
    PCM_REQUIRE_GL(context, GetParam());
    const bool compatibility = GetParam() == Profile::compatibility;
    const TemporaryFolder folder;
    Drawing renderer(make_cloud(folder, "cube", grid_at(map_offset), random_points(5000, 10000, 4)));
    const Framebuffer framebuffer(64, 64);
    GLuint array = 0;
    GLuint buffers[3] = {};
    glGenVertexArrays(1, &array);
    glGenBuffers(3, buffers);
    GLuint textures[2] = {};
    glGenTextures(2, textures);

    std::vector<GLenum> integers{GL_CURRENT_PROGRAM,
                                 GL_VERTEX_ARRAY_BINDING,
                                 GL_ARRAY_BUFFER_BINDING,
                                 GL_ELEMENT_ARRAY_BUFFER_BINDING,
                                 GL_COPY_WRITE_BUFFER,
                                 GL_COPY_READ_BUFFER,
                                 GL_PIXEL_UNPACK_BUFFER_BINDING,
                                 GL_UNIFORM_BUFFER_BINDING,
                                 GL_DEPTH_FUNC,
                                 GL_DEPTH_WRITEMASK,
                                 GL_DRAW_FRAMEBUFFER_BINDING,
                                 GL_READ_FRAMEBUFFER_BINDING,
                                 GL_ACTIVE_TEXTURE,
                                 GL_TEXTURE_BINDING_2D,
                                 GL_BLEND_SRC_RGB,
                                 GL_BLEND_DST_ALPHA,
                                 GL_BLEND_EQUATION_RGB,
                                 GL_DEPTH_RANGE,
                                 GL_COLOR_CLEAR_VALUE,
                                 GL_DEPTH_CLEAR_VALUE,
                                 GL_RENDERBUFFER_BINDING,
                                 GL_TEXTURE_BINDING_2D_MULTISAMPLE,
                                 GL_SAMPLER_BINDING,
                                 GL_CLIP_DEPTH_MODE,
                                 GL_CLIP_ORIGIN,
                                 GL_CULL_FACE_MODE,
                                 GL_FRONT_FACE,
                                 GL_POLYGON_MODE,
                                 GL_VIEWPORT,
                                 GL_SCISSOR_BOX,
                                 GL_COLOR_WRITEMASK,
                                 GL_UNPACK_ALIGNMENT,
                                 GL_POINT_SPRITE_COORD_ORIGIN};
    std::vector<GLenum> switches{
        GL_DEPTH_TEST,  GL_BLEND,  GL_PROGRAM_POINT_SIZE, GL_CULL_FACE,          GL_SCISSOR_TEST, GL_STENCIL_TEST,
        GL_MULTISAMPLE, GL_DITHER, GL_LINE_SMOOTH,        GL_POLYGON_OFFSET_FILL};
    if (compatibility) {
        for (const GLenum e :
             {GL_MATRIX_MODE, GL_ATTRIB_STACK_DEPTH, GL_CLIENT_ATTRIB_STACK_DEPTH, GL_MODELVIEW_STACK_DEPTH,
              GL_PROJECTION_STACK_DEPTH, GL_SHADE_MODEL, GL_CLIENT_ACTIVE_TEXTURE})
            integers.push_back(static_cast<GLenum>(e));
        for (const GLenum e : {GL_POINT_SPRITE, GL_POINT_SMOOTH, GL_LIGHTING, GL_ALPHA_TEST, GL_COLOR_MATERIAL,
                               GL_NORMALIZE, GL_VERTEX_ARRAY, GL_COLOR_ARRAY, GL_TEXTURE_2D})
            switches.push_back(static_cast<GLenum>(e));
    }
    const auto snapshot = [&] {
        std::vector<double> state;
        for (const GLenum name : integers) {
            GLint values[16] = {};
            glGetIntegerv(name, values);
            state.insert(state.end(), values, values + 16);
        }
        for (const GLenum name : switches) state.push_back(glIsEnabled(name));
        GLfloat size = 0;
        glGetFloatv(GL_POINT_SIZE, &size);
        state.push_back(size);
        GLint enabled = 0;
        if (array) glGetVertexAttribiv(0, GL_VERTEX_ATTRIB_ARRAY_ENABLED, &enabled);
        state.push_back(enabled);
        if (compatibility) {
            GLdouble matrix[16];
            glGetDoublev(GL_MODELVIEW_MATRIX, matrix);
            state.insert(state.end(), matrix, matrix + 16);
            GLfloat colour[4];
            glGetFloatv(GL_CURRENT_COLOR, colour);
            state.insert(state.end(), colour, colour + 4);
        }
        return state;
    };

    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 64, 64);
    for (int host = 0; host < 4; ++host) {
        const auto toggle = [&](GLenum what, bool on) { on ? glEnable(what) : glDisable(what); };
        const bool odd = host % 2;
        toggle(GL_DEPTH_TEST, odd);
        toggle(GL_BLEND, odd);
        toggle(GL_PROGRAM_POINT_SIZE, odd);
        if (compatibility) {
            toggle(GL_POINT_SPRITE, odd);
            toggle(GL_POINT_SMOOTH, !odd);
            glPointSize(3.5f);
        }
        toggle(GL_SCISSOR_TEST, odd);
        toggle(GL_STENCIL_TEST, odd);
        toggle(GL_CULL_FACE, odd);
        glScissor(3, 4, 5, 6);
        glCullFace(GL_FRONT_AND_BACK);
        glBlendFuncSeparate(GL_ONE, GL_ZERO, GL_DST_ALPHA, GL_ONE);
        glBlendEquation(odd ? GL_FUNC_SUBTRACT : GL_FUNC_ADD);
        glPolygonMode(GL_FRONT_AND_BACK, odd ? GL_LINE : GL_FILL);
        glColorMask(GL_TRUE, odd ? GL_FALSE : GL_TRUE, GL_TRUE, GL_TRUE);
        glClearColor(0.25f, 0.5f, 0.75f, 1);
        glDepthRange(odd ? 0.25 : 0, odd ? 0.5 : 1);
        glActiveTexture(odd ? GL_TEXTURE1 : GL_TEXTURE0);
        glBindTexture(GL_TEXTURE_2D, textures[odd]);
        glDepthFunc(odd ? GL_GEQUAL : GL_LEQUAL);
        glDepthMask(odd ? GL_FALSE : GL_TRUE);
        glBindVertexArray(host >= 2 ? array : 0);
        glBindBuffer(GL_ARRAY_BUFFER, odd ? buffers[0] : 0);
        glBindBuffer(GL_COPY_WRITE_BUFFER, odd ? buffers[1] : 0);
        for (const ColourMode mode :
             {ColourMode::rgb, ColourMode::intensity, ColourMode::height, ColourMode::uniform}) {
            while (glGetError() != GL_NO_ERROR) {
            }
            const auto before = snapshot();
            while (glGetError() != GL_NO_ERROR) {
            }                  // core contexts do not know all of the names
            glEnable(0xdead);  // an error that the host left behind is not reported as ours
            RenderOptions options = everything();
            renderer.style.colour = mode;
            // All that may be switched on, in one of the hosts.
            options.samples = host >= 2 ? 4 : 1;
            options.eye_dome = odd ? 1.0f : 0.0f;
            FrameReport report;
            for (int frame = 0; frame < 200; ++frame) {
                report = renderer.draw(camera, map_offset, options);
                EXPECT_EQ(report.error, "");
                EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
                ASSERT_EQ(snapshot(), before) << "host " << host << ", mode " << name_of(mode) << ", frame " << frame;
                while (glGetError() != GL_NO_ERROR) {
                }
                if (!report.refining) break;
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            EXPECT_FALSE(report.refining);
            EXPECT_EQ(report.points_drawn, 5000u);
            EXPECT_EQ(report.clouds[0].style.colour, mode);
        }
    }
    renderer.release();
    glDeleteVertexArrays(1, &array);
    glDeleteBuffers(3, buffers);
    glDeleteTextures(2, textures);
}

TEST(Renderer, RefinesWithoutEverShowingLess)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto points = random_points(120000, 10000, 5);
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), points, 2000);
    ASSERT_GT(cloud->tree()->nodes().size(), 60u);  // more than one window of requests
    std::atomic<int> wakes{0};
    for (const double target : {0.0, 3.0}) {
        Drawing renderer(cloud);
        renderer.set_wake([&] { ++wakes; });
        cloud->cache().clear();
        const Framebuffer framebuffer(200, 200);
        const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 200, 200);
        RenderOptions options = everything();
        options.target_spacing_px = target;
        options.converge = false;
        options.fill_gaps = false;
        options.upload_budget_ms = 0;  // one chunk a frame
        FrameReport last;
        last.screen_error_px = 1e9;
        std::size_t lit = 0;
        int frames = 0;
        for (;; ++frames) {
            ASSERT_LT(frames, 20000);
            framebuffer.clear();
            const FrameReport report = renderer.draw(camera, map_offset, options);
            ASSERT_EQ(report.error, "");
            EXPECT_LE(report.screen_error_px, last.screen_error_px);
            EXPECT_GE(report.points_drawn, last.points_drawn);
            EXPECT_LE(report.nodes_drawn, last.nodes_drawn + 2 + static_cast<unsigned>(frames));
            EXPECT_EQ(report.nodes_missing > 0 || report.repaint, report.refining);
            if (frames < 50 || frames % 20 == 0) {
                const std::size_t now = count_lit(framebuffer.read());
                EXPECT_GE(now, lit);
                lit = now;
            }
            last = report;
            if (!report.refining) break;
            if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        EXPECT_LE(last.screen_error_px, target);
        EXPECT_EQ(last.nodes_missing, 0u);
        EXPECT_EQ(last.nodes_drawn, last.nodes_wanted);
        if (target == 0) EXPECT_EQ(last.points_drawn, points.size());
        if (target > 0) EXPECT_LT(last.points_drawn, points.size());
        const L1Statistics s = renderer.l1()->statistics();
        EXPECT_EQ(s.compulsory_misses, last.nodes_drawn);
        EXPECT_EQ(s.capacity_misses, 0u);
        EXPECT_EQ(s.uploaded_bytes, last.points_drawn * 12);  // no colour was asked for, none was uploaded
        renderer.release();
    }
    EXPECT_GT(wakes, 0);
}

TEST(Renderer, ChangingTheColourShowsEveryPointAllTheTime)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(30000, 10000, 6), 2000);
    Drawing renderer(cloud);
    const Framebuffer framebuffer(100, 100);
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    RenderOptions options = everything();
    draw_until_done(renderer, framebuffer, camera, map_offset, options);
    const std::size_t lit = count_lit(framebuffer.read());
    options.upload_budget_ms = 0;
    for (const ColourMode mode : {ColourMode::rgb, ColourMode::intensity, ColourMode::height, ColourMode::rgb}) {
        renderer.style.colour = mode;
        for (int frame = 0;; ++frame) {
            ASSERT_LT(frame, 5000);
            framebuffer.clear();
            const FrameReport report = renderer.draw(camera, map_offset, options);
            ASSERT_EQ(report.points_drawn, 30000u);
            ASSERT_EQ(count_lit(framebuffer.read()), lit);
            if (!report.refining) break;
            if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    renderer.release();
}

TEST(Renderer, ColoursAreTheCloudsOwn)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    // Four points far apart, looked at straight down, 1 unit a pixel.
    std::vector<LasPoint> points(4);
    const std::uint16_t bytes[4][3] = {{255, 0, 10}, {1, 128, 254}, {77, 200, 0}, {0, 0, 33}};
    const Camera camera = view_of(identity(), product(translation(-1, -1, 0), orthographic(20, 20, -10, 10)), 40, 40);
    for (const bool eight_bit : {false, true}) {
        for (std::size_t i = 0; i < 4; ++i) {
            points[i].x = static_cast<std::int32_t>(5500 + 8000 * i);
            points[i].y = 20500;
            points[i].z = static_cast<std::int32_t>(i);
            const int factor = eight_bit ? 1 : 257;
            points[i].red = static_cast<std::uint16_t>(bytes[i][0] * factor);
            points[i].green = static_cast<std::uint16_t>(bytes[i][1] * factor);
            points[i].blue = static_cast<std::uint16_t>(bytes[i][2] * factor);
            points[i].intensity = static_cast<std::uint16_t>(1000 + 100 * i);
        }
        Drawing renderer(make_cloud(folder, eight_bit ? "eight" : "sixteen", grid_at({0, 0, 0}), points));
        const Framebuffer framebuffer(40, 40);
        RenderOptions options = everything();
        renderer.style.point_size_px = 1;
        renderer.style.colour = ColourMode::rgb;
        draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
        auto pixels = framebuffer.read();
        EXPECT_EQ(count_lit(pixels), 4u);
        for (std::size_t i = 0; i < 4; ++i) {
            const Pixel p = pixels[20 * 40 + 5 + 8 * i];
            EXPECT_EQ(p.r, bytes[i][0]);
            EXPECT_EQ(p.g, bytes[i][1]);
            EXPECT_EQ(p.b, bytes[i][2]);
        }
        for (const ColourMode mode : {ColourMode::intensity, ColourMode::height}) {
            renderer.style.colour = mode;
            draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
            pixels = framebuffer.read();
            int before = -1;
            for (std::size_t i = 0; i < 4; ++i) {  // both rise from point to point
                const Pixel p = pixels[20 * 40 + 5 + 8 * i];
                EXPECT_GT(p.r + 2 * p.g, before);
                before = p.r + 2 * p.g;
            }
        }
        renderer.release();
    }
}

// Video memory for a third of what is in view: a moving view shows what fits, a resting one everything.
TEST(Renderer, LivesWithLittleVideoMemory)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(300000, 10000, 7), 4000);
    L1Options l1;
    l1.block_bytes = 1u << 20;
    l1.capacity_bytes = 2u << 20;  // 34 pages; the cloud needs more than 75
    Drawing renderer(cloud, l1);
    const Framebuffer framebuffer(100, 100);
    RenderOptions options = everything();
    renderer.style.colour = ColourMode::rgb;
    for (const bool converge : {false, true}) {
        options.converge = converge;
        for (int step = 0; step < 6; ++step) {
            const Camera view =
                view_of(product(translation(0, 0, 2 * step), overview(10)), perspective(0.9, 1, 0.1, 1000), 100, 100);
            const FrameReport report = draw_until_done(renderer, framebuffer, view, map_offset, options);
            EXPECT_GT(report.points_drawn, 20000u);
            EXPECT_EQ(report.nodes_missing, 0u);
            EXPECT_EQ(report.full_resolution, converge);
            EXPECT_EQ(report.screen_error_px == 0, converge);
            EXPECT_LE(renderer.l1()->statistics().allocated_bytes, l1.capacity_bytes);
        }
    }
    renderer.release();
}

TEST(Renderer, TwoCloudsShareOneCache)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto shared = std::make_shared<L1Cache>();
    Drawing a(make_cloud(folder, "a", grid_at(map_offset), random_points(20000, 10000, 8), 2000), shared);
    Drawing b(make_cloud(folder, "b", grid_at(map_offset), random_points(10000, 10000, 9), 2000), shared);
    const Framebuffer framebuffer(100, 100);
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    EXPECT_EQ(draw_until_done(a, framebuffer, camera, map_offset, everything()).points_drawn, 20000u);
    EXPECT_EQ(draw_until_done(b, framebuffer, camera, map_offset, everything()).points_drawn, 10000u);
    const std::uint64_t both = shared->statistics().resident_chunks;
    a.release();
    EXPECT_LT(shared->statistics().resident_chunks, both);
    EXPECT_EQ(b.draw(camera, map_offset, everything()).points_drawn, 10000u);
    EXPECT_EQ(draw_until_done(a, framebuffer, camera, map_offset, everything()).points_drawn, 20000u);
    a.release();
    b.release();
    EXPECT_EQ(shared->statistics().resident_chunks, 0u);
    shared->release();
    EXPECT_EQ(shared->statistics().allocated_bytes, 0u);
}

TEST(Renderer, ContextsOfOneGroupTakeTurns)
{
    std::string why;
    const auto first = make_offscreen(16, 16, why);
    if (!first) GTEST_SKIP() << why;
    const auto second = make_offscreen(16, 16, why, Profile::compatibility, first.get());
    ASSERT_TRUE(second) << why;
    const TemporaryFolder folder;
    Drawing renderer(make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 10), 2000));
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    second->make_current();
    auto in_second = std::make_unique<Framebuffer>(100, 100);
    Picture of_second;  // a picture is of one context
    first->make_current();
    auto in_first = std::make_unique<Framebuffer>(100, 100);
    draw_until_done(renderer, *in_first, camera, map_offset, everything());
    const auto picture = in_first->read();
    const std::uint64_t uploaded = renderer.l1()->statistics().uploaded_bytes;
    for (int turn = 0; turn < 4; ++turn) {
        (turn % 2 ? first : second)->make_current();
        if (turn % 2 == 0) std::swap(renderer.picture, of_second);
        const Framebuffer& framebuffer = turn % 2 ? *in_first : *in_second;
        framebuffer.bind();
        framebuffer.clear();
        EXPECT_EQ(renderer.draw(camera, map_offset, everything()).points_drawn, 20000u);
        EXPECT_TRUE(framebuffer.read() == picture) << "turn " << turn;
        if (turn % 2 == 0) std::swap(renderer.picture, of_second);
    }
    EXPECT_EQ(renderer.l1()->statistics().uploaded_bytes, uploaded);
    renderer.picture.release();
    in_first.reset();
    second->make_current();
    of_second.release();
    in_second.reset();
    renderer.release();  // with another context of the group current than the one that uploaded
    EXPECT_EQ(renderer.l1()->statistics().allocated_bytes, 0u);
}

TEST(Renderer, ABrokenChunkIsReportedAndTheRestDrawn)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(30000, 10000, 11), 2000);
    const Node broken = cloud->tree()->nodes().back();
    {
        std::fstream file(cloud->tree()->folder() / data_file_name(broken.extent.file),
                          std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(broken.extent.offset + broken.extent.header_bytes + 8));
        // The positions come first; a damaged column that is not read would do no harm.
        const std::string junk(16, '\x55');
        file.write(junk.data(), 16);
    }
    Drawing renderer(cloud);
    const Framebuffer framebuffer(100, 100);
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    RenderOptions options = everything();
    renderer.style.colour = ColourMode::rgb;
    FrameReport report;
    for (int frame = 0; frame < 3000; ++frame) {
        report = renderer.draw(camera, map_offset, options);
        if (!report.refining) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_FALSE(report.refining);
    EXPECT_NE(report.error, "");
    EXPECT_EQ(report.nodes_missing, 1u);
    EXPECT_GT(report.screen_error_px, 0);
    EXPECT_EQ(report.points_drawn, 30000u - broken.points);
    renderer.release();
}

TEST(Renderer, DrawsWidePositions)
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
    EXPECT_EQ(report.clouds[0].style.colour, ColourMode::height);  // it has neither colour nor intensity
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

TEST(Renderer, ViewsThatShowNothingAreHarmless)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    Drawing renderer(make_cloud(folder, "cube", grid_at(map_offset), random_points(1000, 10000, 13)));
    const Framebuffer framebuffer(50, 50);
    Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 50, 50);
    camera.modelview[0] = std::nan("");
    FrameReport report = renderer.draw(camera, map_offset, everything());
    EXPECT_EQ(report.points_drawn, 0u);
    EXPECT_FALSE(report.refining);
    camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 0, 0);
    EXPECT_EQ(renderer.draw(camera, map_offset, everything()).points_drawn, 0u);
    // The cloud behind the eye: nothing is loaded.
    camera = view_of(product(translation(0, 0, 300), overview(10)), perspective(0.9, 1, 0.1, 1000), 50, 50);
    report = renderer.draw(camera, map_offset, everything());
    EXPECT_EQ(report.nodes_wanted, 0u);
    EXPECT_EQ(report.screen_error_px, 0);
    EXPECT_FALSE(report.refining);
    EXPECT_EQ(renderer.l1()->statistics().allocated_bytes, 0u);
    renderer.release();
}
