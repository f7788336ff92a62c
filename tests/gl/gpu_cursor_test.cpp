// Points in buffer objects against the processor's cursor; changes by compute shaders against the same formula in C++.
#include "tests/clouds.h"
#include "tests/gl/gl_support.h"

#include "pcm/system/error.h"
#include "pcm/gl/gpu_cursor.h"
#include "pcm/build/builder.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr std::uint64_t megabyte = 1u << 20;

std::vector<LasPoint> random_points(std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::vector<LasPoint> points(count);
    for (LasPoint& p : points) {
        p.x = static_cast<std::int32_t>(random() % 200000);
        p.y = static_cast<std::int32_t>(random() % 100000);
        p.z = static_cast<std::int32_t>(random() % 30000);
        p.intensity = static_cast<std::uint16_t>(random());
        p.red = static_cast<std::uint16_t>(random());
        p.green = static_cast<std::uint16_t>(random());
        p.blue = static_cast<std::uint16_t>(random());
    }
    return points;
}

const Grid grid{{0.001, 0.001, 0.002}, {500000, 5000000, 100}};

std::filesystem::path make_tree(const TemporaryFolder& folder, const std::string& name, std::size_t points = 60000)
{
    make_cloud(folder, name, grid, random_points(points, points), 7000);
    return folder / (name + ".pct");
}

std::shared_ptr<L1Cache> make_l1(std::uint64_t capacity)
{
    L1Options options;
    options.block_bytes = megabyte;
    options.capacity_bytes = capacity;
    return std::make_shared<L1Cache>(options);
}

std::vector<std::byte> bytes_of(const BufferRange& range)
{
    std::vector<std::byte> bytes(range.bytes);
    glBindBuffer(GL_COPY_WRITE_BUFFER, range.buffer);
    glGetBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(range.offset), static_cast<GLsizeiptr>(range.bytes),
                       bytes.data());
    return bytes;
}

// Of all points of a view.
std::vector<std::byte> positions_of(const GpuView& view)
{
    std::vector<std::byte> all;
    for (const GpuPiece& piece : view.pieces()) {
        EXPECT_EQ(piece.first * piece.positions.bytes, all.size() * piece.count);
        const auto bytes = bytes_of(piece.positions);
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
}

struct CpuChunk {
    std::vector<Vec3i> positions;
    std::vector<std::array<double, 4>> values;  // intensity, rgb
};

std::map<NodeId, CpuChunk> on_the_processor(PointCloud& cloud, Query query)
{
    query.attributes = {"intensity", "rgb"};
    std::map<NodeId, CpuChunk> chunks;
    auto cursor = cloud.points(query);
    for (PointView view; cursor.getNextData(view);) {
        CpuChunk& chunk = chunks[view.node()];
        for (std::size_t i = 0; i < view.size(); ++i) {
            chunk.positions.push_back(view.grid_position(i));
            chunk.values.push_back({view.value(i, 0), view.value(i, 1, 0), view.value(i, 1, 1), view.value(i, 1, 2)});
        }
    }
    return chunks;
}

void expect_equal(const GpuView& view, const CpuChunk& chunk, GpuPositions form)
{
    ASSERT_EQ(view.size(), chunk.positions.size());
    const auto intensity = view.read(0);
    const auto rgb = view.read(1);
    ASSERT_EQ(intensity.size(), view.size() * 2);
    ASSERT_EQ(rgb.size(), view.size() * 6);
    const auto positions = positions_of(view);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < view.size(); ++i) {
        std::uint16_t value[4];
        std::memcpy(value, intensity.data() + i * 2, 2);
        std::memcpy(value + 1, rgb.data() + i * 6, 6);
        for (std::size_t k = 0; k < 4; ++k) wrong += static_cast<double>(value[k]) != chunk.values[i][k];
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int64_t relative = chunk.positions[i][a] - view.origin()[a];
            std::uint64_t wide = 0;
            std::uint32_t narrow = 0;
            float single = 0;
            switch (form) {
                case GpuPositions::none:
                    break;
                case GpuPositions::u32:
                    std::memcpy(&narrow, positions.data() + (3 * i + a) * 4, 4);
                    wrong += narrow != relative;
                    break;
                case GpuPositions::u64:
                    std::memcpy(&wide, positions.data() + (3 * i + a) * 8, 8);
                    wrong += wide != static_cast<std::uint64_t>(relative);
                    break;
                case GpuPositions::f32:
                    std::memcpy(&single, positions.data() + (3 * i + a) * 4, 4);
                    wrong += single != static_cast<float>(static_cast<double>(relative) * view.grid().scale[a]);
                    break;
            }
        }
    }
    EXPECT_EQ(wrong, 0u);
}

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

TEST(GpuCursor, ViewsHoldWhatTheProcessorsCursorGives)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = PointCloud::open(make_tree(folder, "cloud"));
    const auto levels = cloud->info().levels;
    ASSERT_GE(levels, 3);
    for (const GpuPositions form : {GpuPositions::f32, GpuPositions::u32, GpuPositions::u64})
        for (const std::optional<std::uint16_t> level : {std::optional<std::uint16_t>(), {0}, {levels / 2}, {levels}}) {
            Query query;
            query.level = level;
            const auto expected = on_the_processor(*cloud, query);
            query.attributes = {"intensity", "rgb"};
            const auto l1 = make_l1(megabyte);  // of a cloud of 2 MB
            {
                GpuOptions options;
                options.positions = form;
                GpuCursor cursor(cloud, l1, query, options);
                EXPECT_EQ(cursor.nodes().size(), expected.size());
                std::size_t chunks = 0;
                GpuView view;
                for (; cursor.getNextDataGPU(view); ++chunks) {
                    ASSERT_TRUE(expected.count(view.node()));
                    expect_equal(view, expected.at(view.node()), form);
                    EXPECT_LE(l1->statistics().allocated_bytes, megabyte);
                }
                EXPECT_FALSE(view);
                EXPECT_EQ(chunks, expected.size());
                EXPECT_EQ(l1->statistics().forced_misses, chunks);
                // Any of them again, and all from the first.
                const NodeId last = cursor.nodes().back();
                expect_equal(cursor.get(last), expected.at(last), form);
                EXPECT_EQ(l1->statistics().hits, 1u);
                cursor.rewind();
                ASSERT_TRUE(cursor.getNextDataGPU(view));
                EXPECT_EQ(view.node(), cursor.nodes().front());
            }
            EXPECT_EQ(l1->statistics().resident_chunks, 0u);
            l1->release();
        }
}

TEST(GpuCursor, ABoxGivesWholeChunksWithAllItsPoints)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = PointCloud::open(make_tree(folder, "cloud"));
    Query query;
    query.box = Box3d{{500000, 5000000, 0}, {500040, 5000030, 1000}};
    const auto inside = on_the_processor(*cloud, query);
    const auto whole = on_the_processor(*cloud, {});
    ASSERT_LT(inside.size(), whole.size());
    query.attributes = {"intensity", "rgb"};
    const auto l1 = make_l1(16 * megabyte);
    GpuOptions options;
    options.positions = GpuPositions::u32;
    GpuCursor cursor(cloud, l1, query, options);
    std::set<NodeId> seen;
    for (GpuView view; cursor.getNextDataGPU(view); seen.insert(view.node()))
        expect_equal(view, whole.at(view.node()), GpuPositions::u32);
    for (const auto& [node, chunk] : inside) EXPECT_TRUE(seen.count(node));
    EXPECT_LT(seen.size(), whole.size());
}

TEST(GpuCursor, AWideGridComesWholeAsPairsOfWords)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    Grid one{{0.001, 0.001, 0.001}, {0, 0, 0}}, two = one;
    two.offset[0] = 8e6;
    write_las_points(folder / "a.las", one, random_points(3000, 1));
    write_las_points(folder / "b.las", two, random_points(3000, 2));
    BuildOptions build;
    build.chunk_points = 1000;
    build_tree({folder / "a.las", folder / "b.las"}, folder / "out.pct", build);
    const auto cloud = PointCloud::open(folder / "out.pct");
    ASSERT_TRUE(cloud->info().wide);
    const auto expected = on_the_processor(*cloud, {});
    Query query;
    query.attributes = {"intensity", "rgb"};
    GpuOptions options;
    options.positions = GpuPositions::u32;
    const auto l1 = make_l1(megabyte);
    EXPECT_THROW(GpuCursor(cloud, l1, query, options), Error);
    for (const GpuPositions form : {GpuPositions::u64, GpuPositions::f32}) {
        options.positions = form;
        GpuCursor cursor(cloud, l1, query, options);
        for (GpuView view; cursor.getNextDataGPU(view);) expect_equal(view, expected.at(view.node()), form);
    }
}

TEST(GpuCursor, WhatAComputeShaderWritesIsInTheTreeAfterwards)
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
        l2.capacity_bytes = 300000;  // a few chunks: what comes back from video memory goes on to the disk
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

TEST(GpuCursor, ACursorThatEndsEarlyLosesNothing)
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

TEST(GpuCursor, AllOfALevelIsThereAtOnceOrRefusedBeforehand)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = PointCloud::open(make_tree(folder, "cloud"));
    const auto l1 = make_l1(megabyte);
    Query query;
    query.attributes = {"intensity", "rgb"};
    const auto uploaded = [&] { return l1->statistics().uploaded_bytes; };
    try {
        GpuCursor(cloud, l1, query).load_all();
        FAIL() << "44 pages of 60 kB in 1 MB";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::no_space);
        EXPECT_NE(std::string(error.what()).find("need 3 MB"), std::string::npos) << error.what();
    }
    EXPECT_EQ(uploaded(), 0u);
    query.level = 0;
    GpuCursor cursor(cloud, l1, query);
    const auto views = cursor.load_all();
    const auto expected = on_the_processor(*cloud, query);
    ASSERT_EQ(views.size(), expected.size());
    for (const GpuView& view : views) expect_equal(view, expected.at(view.node()), GpuPositions::f32);
}

TEST(GpuCursor, MisuseIsToldByWhatIsWrong)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = PointCloud::open(make_tree(folder, "cloud"));
    const auto l1 = make_l1(megabyte);
    const auto message = [](const auto& act) -> std::string {
        try {
            act();
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    };
    const auto expect_says = [&](const std::string& words, const auto& act) {
        const std::string said = message(act);
        EXPECT_NE(said.find(words), std::string::npos) << said;
    };
    Query query;
    query.attributes = {"teapot"};
    expect_says("no attribute 'teapot'", [&] { GpuCursor(cloud, l1, query); });
    query.attributes = {"intensity"};
    query.where = {parse_condition("intensity > 5")};
    expect_says("not tested on whole chunks", [&] { GpuCursor(cloud, l1, query); });
    query.where.clear();

    GpuView view;
    expect_says("empty view", [&] { view.mark_written(0); });
    expect_says("empty view", [&] { view.read(0); });
    expect_says("empty view", [&] { view.grid(); });
    GpuCursor cursor(cloud, l1, query);
    expect_says("not among those of the query", [&] { cursor.get(no_node); });
    ASSERT_TRUE(cursor.getNextDataGPU(view));
    expect_says("no attribute number 1", [&] { view.mark_written(1); });
    expect_says("no attribute number 9", [&] { view.read(9); });
    const std::string said = message([&] { view.mark_written(0); });  // the cloud was opened for reading
    EXPECT_NE(said.find("read"), std::string::npos) << said;
    expect_says("views", [&] { l1->release(); });

    // Views that are never let go of fill video memory.
    std::vector<GpuView> hoard;
    expect_says("held by views", [&] {
        for (const NodeId node : cursor.nodes()) hoard.push_back(cursor.get(node));
    });
    hoard.clear();
    EXPECT_TRUE(cursor.getNextDataGPU(view));
    Query cancelling = query;
    cancelling.progress = [](const ProgressUpdate&) { return false; };
    expect_says("cancelled", [&] { GpuCursor(cloud, l1, cancelling).getNextDataGPU(view); });
}

TEST(GpuCursor, AWriteWithoutAMarkIsFoundWhenAskedFor)
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

TEST(GpuCursor, AClosedCloudRefusesChangesAndTheyCanBeDiscarded)
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
