#include "tests/clouds.h"
#include "tests/offscreen_support.h"
#include "tests/support.h"

#include "pcm/build/builder.h"
#include "pcm/offscreen/scene.h"
#include "pcm/system/error.h"

#include <GL/glew.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

#define REQUIRE_OFFSCREEN(name, ...)                           \
    std::string name##_why;                                    \
    const auto name = make_offscreen(__VA_ARGS__, name##_why); \
    if (!name) GTEST_SKIP() << name##_why

TEST(Offscreen, WhatIsDrawnIsReadUpperRowFirst)
{
    REQUIRE_OFFSCREEN(screen, 33, 20);
    EXPECT_FALSE(screen->renderer().empty());
    screen->clear({0, 0, 0, 0});
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 19, 3, 1);  // OpenGL counts from below
    glClearColor(1, 0.2f, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
    const Image image = screen->read();
    ASSERT_EQ(image.rgba.size(), 33u * 20 * 4);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 33; ++x) {
            const bool drawn = y == 0 && x < 3;
            EXPECT_EQ(image.pixel(x, y)[0], drawn ? 255 : 0);
            EXPECT_EQ(image.pixel(x, y)[1], drawn ? 51 : 0);
            EXPECT_EQ(image.pixel(x, y)[3], drawn ? 255 : 0);
        }
}

TEST(Offscreen, SizesThatCannotBeDrawnAreRefused)
{
    REQUIRE_OFFSCREEN(screen, 1, 1);
    for (const auto& [width, height] : {std::pair{0, 5}, {5, -1}, {1 << 30, 4}}) {
        try {
            const Offscreen none(width, height);
            ADD_FAILURE() << width << " x " << height;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            EXPECT_NE(std::string(error.what()).find(std::to_string(width)), std::string::npos) << error.what();
        }
    }
}

TEST(Offscreen, ContextsShareObjectsAndTakeTurns)
{
    REQUIRE_OFFSCREEN(first, 8, 8);
    std::string why;
    const auto second = make_offscreen(4, 4, why, OffscreenProfile::compatibility, first.get());
    ASSERT_TRUE(second) << why;
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glFinish();
    first->make_current();
    EXPECT_TRUE(glIsBuffer(buffer));
    first->clear({0, 1, 0, 1});
    EXPECT_EQ(first->read().pixel(7, 7)[1], 255);
    second->make_current();
    second->clear({0, 0, 1, 1});
    EXPECT_EQ(second->read().pixel(3, 3)[2], 255);
    glDeleteBuffers(1, &buffer);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(Offscreen, ACoreProfileHasNoOldFunctions)
{
    std::string why;
    const auto screen = make_offscreen(8, 8, why, OffscreenProfile::core);
    if (!screen) GTEST_SKIP() << why;
    GLint mask = 0;
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &mask);
    EXPECT_TRUE(mask & GL_CONTEXT_CORE_PROFILE_BIT);
}

// A scene of two clouds, whose chunks are loaded as they are drawn.
TEST(Offscreen, AScenesLoadedBytesAreThoseOfItsClouds)
{
    REQUIRE_OFFSCREEN(screen, 64, 48);
    const TemporaryFolder folder;
    std::vector<std::filesystem::path> trees;
    for (const std::uint32_t seed : {1u, 2u}) {
        const std::filesystem::path las = folder / (std::to_string(seed) + ".las");
        Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        write_las(las, records(Shape::surface, 2000 * seed, seed), grid);
        trees.push_back(folder / (std::to_string(seed) + ".pct"));
        build_tree({las}, trees.back());
    }
    OffscreenScene scene(trees);
    EXPECT_EQ(scene.loaded_bytes(), 0u);
    const Camera view = scene.view_of(overview_of(scene.box(), 45, 64, 48), 64, 48);
    FrameReport report;
    do {
        screen->clear();
        report = scene.draw(view, {}, {});
        if (report.refining && !report.repaint) scene.wait();
    } while (report.refining);
    EXPECT_EQ(report.points_drawn, 6000u);
    std::uint64_t sum = 0;
    for (const auto& cloud : scene.clouds()) {
        EXPECT_GT(cloud->cache().statistics().loaded_bytes, 20000u);
        sum += cloud->cache().statistics().loaded_bytes;
    }
    EXPECT_EQ(scene.loaded_bytes(), sum);
}

}  // namespace
