// Points in buffer objects against the processor's cursor.
#include "tests/clouds.h"
#include "tests/gl/gpu_support.h"

#include "pcm/build/builder.h"
#include "pcm/gl/compute/gpu_cursor.h"
#include "pcm/system/error.h"

#include <cstring>
#include <map>

using namespace pcm;
using namespace pcm::test;

namespace {

// The positions of all points of a view.
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
            const auto l1 = make_l1(megabyte);  // the cloud has 2 MB
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
                // Any chunk again, and all from the first.
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
    write_las_points(folder / "a.las", one, coloured_points(3000, 1));
    write_las_points(folder / "b.las", two, coloured_points(3000, 2));
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

TEST(GpuCursor, MisuseIsReportedByItsCause)
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

    // Views that are never released fill video memory.
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
