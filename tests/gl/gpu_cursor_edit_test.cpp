// Changes by compute shaders against the same formula in C++.
#include "tests/clouds.h"
#include "tests/gl/gpu_support.h"

#include "pcm/build/builder.h"
#include "pcm/gl/compute/gpu_cursor.h"
#include "pcm/system/error.h"

#include <cstring>

using namespace pcm;
using namespace pcm::test;

namespace {

GLuint compute_program(const char* source)
{
    const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    const GLuint program = glCreateProgram();
    glAttachShader(program, shader);
    glLinkProgram(program);
    glDeleteShader(shader);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    EXPECT_TRUE(linked);
    return program;
}

// Attribute 0 becomes the squared distance to the chunk's origin in grid steps, modulo 2^32, plus `add`: integers, so
// that every machine agrees bit for bit.
const char* const distances = R"(#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Positions { uint position[]; };
layout(std430, binding = 1) buffer Values { uint value[]; };
uniform uint count, add;
void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    uint x = position[3u * i], y = position[3u * i + 1u], z = position[3u * i + 2u];
    value[i] = x * x + y * y + z * z + add;
}
)";

void run(GLuint program, const GpuView& view, std::uint32_t add)
{
    glUseProgram(program);
    glUniform1ui(glGetUniformLocation(program, "add"), add);
    for (const GpuPiece& piece : view.pieces()) {
        const auto bind = [](GLuint index, const BufferRange& range) {
            glBindBufferRange(GL_SHADER_STORAGE_BUFFER, index, range.buffer, static_cast<GLintptr>(range.offset),
                              static_cast<GLsizeiptr>(range.bytes));
        };
        bind(0, piece.positions);
        bind(1, piece.attributes[0]);
        glUniform1ui(glGetUniformLocation(program, "count"), piece.count);
        glDispatchCompute((piece.count + 63) / 64, 1, 1);
    }
}

std::uint32_t distance(const Vec3i& point, const Vec3i& origin, std::uint32_t add)
{
    std::uint32_t sum = add;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto d = static_cast<std::uint32_t>(point[a] - origin[a]);
        sum += d * d;
    }
    return sum;
}

// Number of points whose `name` is not the distance.
std::size_t count_wrong(PointCloud& cloud, const std::string& name, std::uint32_t add)
{
    Query query;
    query.attributes = {name};
    std::size_t wrong = 0, points = 0;
    auto cursor = cloud.points(query);
    for (PointView view; cursor.getNextData(view); points += view.size()) {
        const auto chunk = cloud.cache().get(view.node(), ColumnSet::only_positions());
        for (std::size_t i = 0; i < view.size(); ++i)
            wrong +=
                view.value(i, 0) != static_cast<double>(distance(view.grid_position(i), chunk->positions->origin, add));
    }
    EXPECT_EQ(points, cloud.info().points);
    return wrong;
}

#define PCM_REQUIRE_COMPUTE                 \
    PCM_REQUIRE_GL(context, Profile::core); \
    try {                                   \
        require_compute_shaders();          \
    } catch (const Error& error) {          \
        GTEST_SKIP() << error.what();       \
    }

}  // namespace

TEST(GpuCursorEdit, WhatAComputeShaderWritesIsInTheTreeAfterwards)
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    const auto path = make_tree(folder, "cloud");
    const GLuint program = compute_program(distances);
    GpuOptions options;
    options.positions = GpuPositions::u32;
    Query query;
    query.attributes = {"distance"};
    for (const std::uint64_t capacity : {megabyte, 64 * megabyte}) {
        const auto add = static_cast<std::uint32_t>(capacity);
        const auto l1 = make_l1(capacity);
        L2Options l2;
        l2.capacity_bytes = 300000;  // a few chunks: columns that are written back reach the disk
        {
            const auto cloud = PointCloud::open(path, l2, Access::write);
            if (!cloud->info().schema.find("distance")) cloud->add_attribute({"distance", ScalarType::u32});
            GpuCursor cursor(cloud, l1, query, options);
            std::size_t points = 0;
            for (GpuView view; cursor.getNextDataGPU(view); points += view.size()) {
                run(program, view, add);
                view.mark_written(0);
            }
            EXPECT_EQ(points, cloud->info().points);
            EXPECT_EQ(l1->statistics().written_back_chunks, cursor.nodes().size());
            EXPECT_EQ(l1->statistics().written_back_bytes, points * 4);
            EXPECT_EQ(count_wrong(*cloud, "distance", add), 0u);
            // A second pass on the GPU reads what the first one wrote.
            cursor.rewind();
            for (GpuView view; cursor.getNextDataGPU(view);) {
                const auto chunk = cloud->cache().get(view.node(), ColumnSet::only_positions());
                const auto bytes = view.read(0);
                std::vector<std::uint32_t> values(view.size());
                std::memcpy(values.data(), bytes.data(), bytes.size());
                for (std::size_t i = 0; i < view.size(); ++i)
                    ASSERT_EQ(values[i], distance(chunk->positions->grid(i), view.origin(), add));
            }
            cloud->close();
        }
        EXPECT_EQ(count_wrong(*PointCloud::open(path), "distance", add), 0u);
        l1->release();
    }
    glDeleteProgram(program);
}

TEST(GpuCursorEdit, ACursorThatEndsEarlyLosesNothing)
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    const auto path = make_tree(folder, "cloud", 20000);
    const GLuint program = compute_program(distances);
    auto l1 = make_l1(64 * megabyte);
    auto cloud = PointCloud::open(path, {}, Access::write);
    cloud->add_attribute({"distance", ScalarType::u32});
    Query query;
    query.attributes = {"distance"};
    GpuOptions options;
    options.positions = GpuPositions::u32;
    GpuView kept;
    {
        GpuCursor cursor(cloud, l1, query, options);
        std::size_t left = cursor.nodes().size();
        for (GpuView view; left > 0 && cursor.getNextDataGPU(view); --left) {
            run(program, view, 5);
            view.mark_written(0);
            kept = view;
        }
    }
    EXPECT_EQ(l1->statistics().written_back_chunks, 0u);
    EXPECT_GT(l1->statistics().resident_chunks, 1u);
    // A view outlives its cursor, and keeps cloud and cache alive.
    EXPECT_THROW(l1->release(), Error);
    EXPECT_EQ(kept.read(0).size(), kept.size() * 4);
    kept = {};
    l1->flush();
    EXPECT_EQ(l1->statistics().resident_chunks, 0u);
    EXPECT_EQ(count_wrong(*cloud, "distance", 5), 0u);
    l1->release();
    glDeleteProgram(program);
}

TEST(GpuCursorEdit, AWriteWithoutAMarkIsFoundWhenAskedFor)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = PointCloud::open(make_tree(folder, "cloud", 20000), {}, Access::write);
    const auto l1 = make_l1(16 * megabyte);
    Query query;
    query.attributes = {"intensity", "rgb"};
    GpuOptions options;
    options.check_marks = true;
    const auto spoil = [](const BufferRange& range) {
        const std::uint16_t value = 12345;
        glBindBuffer(GL_COPY_WRITE_BUFFER, range.buffer);
        glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(range.offset + range.bytes - 2), 2, &value);
    };
    GpuCursor cursor(cloud, l1, query, options);
    GpuView view;
    ASSERT_TRUE(cursor.getNextDataGPU(view));
    ASSERT_TRUE(cursor.getNextDataGPU(view));  // nothing was changed
    spoil(view.pieces().back().attributes[1]);
    view.mark_written(1);
    ASSERT_TRUE(cursor.getNextDataGPU(view));
    const NodeId node = view.node();
    spoil(view.pieces().back().attributes[0]);
    view.mark_written(1);
    try {
        cursor.getNextDataGPU(view);
        FAIL() << "not found";
    } catch (const Error& error) {
        const std::string said = error.what();
        EXPECT_NE(said.find("'intensity' of node " + std::to_string(node)), std::string::npos) << said;
        EXPECT_NE(said.find("mark_written"), std::string::npos) << said;
    }
    ASSERT_TRUE(cursor.getNextDataGPU(view));
    spoil(view.pieces().back().positions);
    EXPECT_THROW(cursor.getNextDataGPU(view), Error);
    cursor.discard();
    while (cursor.getNextDataGPU(view)) {
    }
    EXPECT_EQ(l1->statistics().written_back_chunks, 0u);
}

TEST(GpuCursorEdit, AClosedCloudRefusesChangesAndTheyCanBeDiscarded)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = PointCloud::open(make_tree(folder, "cloud", 20000), {}, Access::write);
    const auto l1 = make_l1(16 * megabyte);
    Query query;
    query.attributes = {"intensity"};
    GpuCursor cursor(cloud, l1, query);
    GpuView view;
    ASSERT_TRUE(cursor.getNextDataGPU(view));
    view.mark_written(0);
    cloud->close();
    EXPECT_THROW(cursor.flush(), Error);
    EXPECT_THROW(cursor.getNextDataGPU(view), Error);
    EXPECT_EQ(l1->statistics().failed_write_backs, 1u);
    view = {};
    EXPECT_THROW(l1->release(), Error);
    cursor.discard();
    l1->release();
}
