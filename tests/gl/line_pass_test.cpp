// Lines and crosses over a picture: where they are, how wide, what hides them, and what they leave behind.
#include "tests/gl/gl_support.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/draw/line_pass.h"
#include "pcm/view/screen_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int size = 128;

class LinePassIn : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, LinePassIn, testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) { return info.param == Profile::core ? "Core" : "Compatibility"; });

bool is_lit(const Pixel& p) { return p.g > 128; }

// The rows that are lit in a column.
std::pair<int, int> lit_rows(const std::vector<Pixel>& pixels, int x)
{
    std::pair<int, int> rows{size, -1};
    for (int y = 0; y < size; ++y)
        if (is_lit(pixels[static_cast<std::size_t>(y * size + x)])) {
            rows.first = std::min(rows.first, y);
            rows.second = std::max(rows.second, y);
        }
    return rows;
}

SceneLine line_of(const Vec3d& from, const Vec3d& to, double width = 4)
{
    SceneLine line;
    line.points = {from, to};
    line.width_px = width;
    return line;
}

Camera looking(double near = 0.1, const Vec3d& origin = {})
{
    return view_of(translation(0, 0, -5), perspective(pi / 2, 1, near, 1000), size, size, origin);
}

}  // namespace

TEST_P(LinePassIn, DrawsALineOfTheGivenWidthWhereItIs)
{
    PCM_REQUIRE_GL(context, GetParam());
    const Framebuffer framebuffer(size, size);
    LinePass pass;
    // At a depth of 5 a unit is 64 / 5 pixels.
    pass.draw(looking(), {line_of({-10, 1.25, 0}, {10, 1.25, 0}, 6)}, {});
    const auto pixels = framebuffer.read();
    for (const int x : {0, 40, size - 1}) EXPECT_EQ(lit_rows(pixels, x), std::make_pair(77, 82)) << x;
    pass.release();
    EXPECT_EQ(drain_gl_errors(), "");
}

TEST_P(LinePassIn, IsWhereItBelongsAtMapCoordinatesAndBeforeATinyNearPlane)
{
    PCM_REQUIRE_GL(context, GetParam());
    const Framebuffer framebuffer(size, size);
    LinePass pass;
    // The eye is 5 millimetres from a line that lies 1 mm off its axis: 12.8 pixels.
    const Vec3d origin{500000.125, 5000000.25, 100.5};
    Camera camera = view_of(translation(0, 0, -0.005), perspective(pi / 2, 1, 1e-6, 1000), size, size, origin);
    pass.draw(camera, {line_of(origin + Vec3d{-1e-2, 1e-3, 0}, origin + Vec3d{1e-2, 1e-3, 0}, 2)}, {});
    const auto rows = lit_rows(framebuffer.read(), 30);
    EXPECT_NEAR((rows.first + rows.second + 1) / 2.0, 64 + 12.8, 0.51);
    pass.release();
}

// An end that is behind the eye, and one that is very far away.
TEST_P(LinePassIn, IsClippedAtTheNearPlaneAndKeepsItsDirection)
{
    PCM_REQUIRE_GL(context, GetParam());
    const Framebuffer framebuffer(size, size);
    LinePass pass;
    // Below the eye by 1, along the view: from the lower border up to the centre.
    pass.draw(looking(), {line_of({0, -1, 40}, {0, -1, -1e9}, 2)}, {});
    auto pixels = framebuffer.read();
    for (const int y : {2, 30, 60}) EXPECT_TRUE(is_lit(pixels[static_cast<std::size_t>(y * size + 64)])) << y;
    for (const int y : {70, 100, 126}) EXPECT_FALSE(is_lit(pixels[static_cast<std::size_t>(y * size + 64)])) << y;

    framebuffer.clear();
    pass.draw(looking(), {line_of({-1e9, 1e9 + 1.25, 0}, {1e9, -1e9 + 1.25, 0}, 2)}, {});
    pixels = framebuffer.read();
    EXPECT_TRUE(is_lit(pixels[static_cast<std::size_t>(80 * size + 64)]));
    EXPECT_TRUE(is_lit(pixels[static_cast<std::size_t>(64 * size + 80)]));

    framebuffer.clear();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    pass.draw(looking(), {line_of({0, 0, 6}, {0, 1, 50}), line_of({nan, 0, 0}, {1, 0, 0})}, {});
    EXPECT_EQ(count_lit(framebuffer.read()), 0u) << "behind the eye, and not a number";
    pass.release();
}

TEST_P(LinePassIn, IsFaintWhereSomethingHidesIt)
{
    PCM_REQUIRE_GL(context, GetParam());
    const Framebuffer framebuffer(size, size);
    LinePass pass;
    // The left half holds something at the near plane.
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, size / 2, size);
    glClearDepth(0);
    glClear(GL_DEPTH_BUFFER_BIT);
    glClearDepth(1);
    glDisable(GL_SCISSOR_TEST);
    SceneLine hidden = line_of({-10, 1.25, 0}, {10, 1.25, 0}), on_top = line_of({-10, -1.25, 0}, {10, -1.25, 0});
    hidden.hidden = 0.25f;
    on_top.hidden = 1;
    pass.draw(looking(), {hidden, on_top}, {});
    const auto pixels = framebuffer.read();
    const auto at = [&](int x, int y) { return int(pixels[static_cast<std::size_t>(y * size + x)].g); };
    EXPECT_NEAR(at(30, 80), 64, 1);
    EXPECT_EQ(at(100, 80), 255);
    EXPECT_EQ(at(30, 48), 255);
    EXPECT_EQ(at(100, 48), 255);
    float depth = 0;
    glReadPixels(100, 80, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    EXPECT_EQ(depth, 1) << "lines hide nothing that is drawn later";
    pass.release();
}

// Splats at the place of a line do not hide it.
TEST_P(LinePassIn, IsSeenBeforeWhatLiesAtItsPlace)
{
    PCM_REQUIRE_GL(context, GetParam());
    for (const bool orthographic_view : {false, true}) {
        const Framebuffer framebuffer(size, size);
        LinePass pass;
        const Camera camera =
            orthographic_view ? view_of(translation(0, 0, -5), orthographic(5, 5, 0.1, 1000), size, size) : looking();
        const auto map = ScreenMap::of(camera);
        ASSERT_TRUE(map);
        glClearDepth((*map->place_of({0, 0, 0.05}))[2] / 2 + 0.5);  // half a pixel nearer than the line
        glClear(GL_DEPTH_BUFFER_BIT);
        glClearDepth(1);
        pass.draw(camera, {line_of({-10, 0, 0}, {10, 0, 0})}, {});
        EXPECT_EQ(int(framebuffer.read()[64 * size + 20].g), 255);
        pass.release();
    }
}

TEST_P(LinePassIn, IsSeenBeyondTheFarPlane)
{
    PCM_REQUIRE_GL(context, GetParam());
    const Framebuffer framebuffer(size, size);
    LinePass pass;
    const Camera camera = view_of(translation(0, 0, -5), perspective(pi / 2, 1, 0.1, 4), size, size);
    pass.draw(camera, {line_of({-10, 0, 0}, {10, 0, 0})}, {});
    EXPECT_GT(count_lit(framebuffer.read()), 100u);
    pass.release();
}

TEST_P(LinePassIn, DrawsCrossesOfAFixedSizeAndClosesPolygons)
{
    PCM_REQUIRE_GL(context, GetParam());
    const Framebuffer framebuffer(size, size);
    LinePass pass;
    SceneMark mark;
    mark.at = {0, 0, 0};
    mark.size_px = 20;
    mark.width_px = 2;
    for (const double depth : {1.0, 50.0}) {
        framebuffer.clear();
        const Camera camera = view_of(translation(0, 0, -depth), perspective(pi / 2, 1, 0.01, 1000), size, size);
        pass.draw(camera, {}, {mark});
        const auto pixels = framebuffer.read();
        int column = 0, row = 0;
        for (int i = 0; i < size; ++i) {
            column += is_lit(pixels[static_cast<std::size_t>(i * size + 64)]);
            row += is_lit(pixels[static_cast<std::size_t>(64 * size + i)]);
        }
        EXPECT_NEAR(column, 21, 1) << depth;
        EXPECT_NEAR(row, 21, 1) << depth;
    }

    // Behind the eye there is none, nor where it would be mirrored to.
    framebuffer.clear();
    for (const double behind : {0.5, 3.0, 400.0})
        pass.draw(view_of(translation(0.1, 0.2, behind), perspective(pi / 2, 1, 0.01, 1000), size, size), {}, {mark});
    EXPECT_EQ(count_lit(framebuffer.read()), 0u);

    SceneLine square;
    square.points = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
    framebuffer.clear();
    pass.draw(looking(), {square}, {});
    const std::size_t left = 64 * size + 64 - 26;
    EXPECT_FALSE(is_lit(framebuffer.read()[left]));
    square.closed = true;
    pass.draw(looking(), {square}, {});
    EXPECT_TRUE(is_lit(framebuffer.read()[left]));
    pass.release();
}

TEST_P(LinePassIn, LeavesTheStateOfTheHostAsItWas)
{
    PCM_REQUIRE_GL(context, GetParam());
    const Framebuffer framebuffer(size, size);
    LinePass pass;
    GLuint array = 0, buffer = 0;
    glGenVertexArrays(1, &array);
    glGenBuffers(1, &buffer);
    for (const bool odd : {false, true}) {
        odd ? glEnable(GL_BLEND) : glDisable(GL_BLEND);
        odd ? glEnable(GL_CULL_FACE) : glDisable(GL_CULL_FACE);
        odd ? glDisable(GL_DEPTH_TEST) : glEnable(GL_DEPTH_TEST);
        glDepthMask(odd);
        glDepthFunc(odd ? GL_GEQUAL : GL_LESS);
        glBindVertexArray(odd ? array : 0);
        glBindBuffer(GL_ARRAY_BUFFER, odd ? buffer : 0);
        glPolygonMode(GL_FRONT_AND_BACK, odd ? GL_LINE : GL_FILL);
        const auto state = [] {
            std::vector<GLint> values;
            for (const GLenum name :
                 {GL_CURRENT_PROGRAM, GL_VERTEX_ARRAY_BINDING, GL_ARRAY_BUFFER_BINDING, GL_DEPTH_FUNC,
                  GL_DEPTH_WRITEMASK, GL_BLEND_SRC_RGB, GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_POLYGON_MODE,
                  GL_DRAW_FRAMEBUFFER_BINDING, GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST, GL_MULTISAMPLE}) {
                GLint value[4] = {};
                glGetIntegerv(name, value);
                values.insert(values.end(), value, value + 4);
            }
            return values;
        };
        const auto before = state();
        framebuffer.clear();
        pass.draw(looking(), {line_of({-10, 0, 0}, {10, 0, 0})}, {});
        EXPECT_EQ(state(), before);
        EXPECT_EQ(drain_gl_errors(), "");
        glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    }
    glBindVertexArray(0);
    glDeleteVertexArrays(1, &array);
    glDeleteBuffers(1, &buffer);
    pass.release();
}
