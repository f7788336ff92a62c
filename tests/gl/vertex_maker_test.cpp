// Vertices are made by loader threads: the same whichever thread makes them, and an upload reads no chunk.
#include "pcm/gl/draw/vertex_maker.h"
#include "pcm/gl/draw/chunk_feed.h"
#include "tests/gl/gl_support.h"

#include <atomic>
#include <cmath>
#include <cstring>

using namespace pcm;
using namespace pcm::test;

namespace {

std::shared_ptr<PointCloud> coloured_cube(const TemporaryFolder& folder)
{
    return make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 21), 1500);
}

CloudStyle fitted_style()
{
    CloudStyle style;
    style.splats = SplatMode::fitted;
    style.colour = ColourMode::rgb;
    return style;
}

VertexRecipe recipe_of(const PointCloud& cloud)
{
    VertexRecipe recipe;
    recipe.tree = cloud.tree();
    recipe.format = format_of(fitted_style());
    recipe.colour = AttributePlace{*cloud.info().schema.find("rgb"), 0};
    recipe.scale = {0, 65535};
    recipe.sizes = std::make_shared<const PointSizes>(*recipe.tree);
    return recipe;
}

// Vertices as they are in video memory.
std::vector<std::byte> bytes_of(const VertexEntry& entry)
{
    std::vector<std::byte> bytes(std::size_t(entry.points) * entry.stride());
    std::size_t at = 0;
    for (const VertexRange& range : entry.ranges) {
        const std::size_t count = static_cast<std::size_t>(range.count) * entry.stride();
        glBindBuffer(GL_COPY_READ_BUFFER, range.buffer);
        glGetBufferSubData(GL_COPY_READ_BUFFER, std::int64_t(range.first) * entry.stride(),
                           static_cast<GLsizeiptr>(count), bytes.data() + at);
        at += count;
    }
    return bytes;
}

// What loader threads say, and how often.
class Wakes {
public:
    explicit Wakes(ChunkFeed& feed) : feed_(feed)
    {
        feed.set_wake([this] { ++count_; });
    }
    ~Wakes() { feed_.set_wake({}); }
    int count() const { return count_; }
    bool come(int count) const
    {
        for (int tries = 0; tries < 2000 && count_ < count; ++tries)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return count_ >= count;
    }

private:
    ChunkFeed& feed_;
    std::atomic<int> count_{0};
};

}  // namespace

TEST(VertexMaker, MakesTheSameOnEveryThread)
{
    const TemporaryFolder folder;
    const auto cloud = coloured_cube(folder);
    const VertexMaker maker(recipe_of(*cloud));
    const std::size_t nodes = cloud->tree()->nodes().size();
    ASSERT_GT(nodes, 5u);
    std::vector<ChunkVertices> expected;
    for (NodeId node = 0; node < nodes; ++node)
        expected.push_back(maker.make(node, *cloud->cache().get(node, maker.columns())).vertices);
    std::atomic<int> different{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < 2 * nodes; ++i) {
                const auto node = static_cast<NodeId>((i + static_cast<std::size_t>(t) * 3) % nodes);
                const auto made = maker.make(node, *cloud->cache().get(node, maker.columns())).vertices;
                different += made.bytes != expected[node].bytes || made.points != expected[node].points ||
                             made.largest_radius != expected[node].largest_radius;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(different, 0);
}

TEST(VertexMaker, MarksSelectedPoints)
{
    const TemporaryFolder folder;
    const auto cloud = coloured_cube(folder);
    VertexRecipe recipe = recipe_of(*cloud);
    const Chunk& root = *cloud->cache().get(0, VertexMaker(recipe).columns());
    PointSet selected(cloud->tree());
    selected.set(0, {1, 5, 7});
    recipe.selected = std::make_shared<const PointSet>(selected);
    const auto made = VertexMaker(recipe).make(0, root).vertices;
    EXPECT_EQ(made.points, root.points);
    EXPECT_EQ(made.selection, selection_number(selected, 0));
    EXPECT_NE(made.selection, 0u);
    std::vector<std::uint32_t> marked;
    for (std::uint32_t i = 0; i < made.points; ++i) {
        float x;
        std::memcpy(&x, made.bytes.data() + i * made.stride(), 4);
        if (std::signbit(x)) marked.push_back(i);
    }
    EXPECT_EQ(marked, (std::vector<std::uint32_t>{1, 5, 7}));
}

// A chunk that is in L2 already is not read on the GL thread either: its vertices come from a loader thread, and are
// uploaded although L2 has dropped the chunk meanwhile.
TEST(ChunkFeed, UploadsWhatLoaderThreadsHaveMade)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = coloured_cube(folder);
    const auto l1 = std::make_shared<L1Cache>();
    ChunkFeed feed(cloud, l1);
    const Wakes wakes(feed);
    std::string notice;
    CloudStyle style = fitted_style();
    style.colour = ColourMode::uniform;
    const VertexFormat format = feed.format_of(style, {}, notice);
    const std::vector<NodeId> window{0, 1};
    const auto frame = [&] {
        feed.begin_frame();
        l1->begin_frame(feed.owner());
        feed.load(window, {}, format);
    };
    const VertexMaker maker = [&] {
        VertexRecipe recipe = recipe_of(*cloud);
        recipe.format = format;
        recipe.colour.reset();
        return VertexMaker(std::move(recipe));
    }();
    std::vector<ChunkVertices> expected;
    for (const NodeId node : window)
        expected.push_back(maker.make(node, *cloud->cache().get(node, maker.columns())).vertices);

    frame();
    EXPECT_TRUE(feed.waits());
    ASSERT_TRUE(wakes.come(1));
    cloud->cache().wait_idle();
    frame();
    EXPECT_FALSE(feed.waits());
    cloud->cache().clear();
    ASSERT_FALSE(cloud->cache().find(0, maker.columns()));
    EXPECT_EQ(feed.upload(window, format, 1000).uploaded, 2u);
    for (std::size_t k = 0; k < window.size(); ++k) {
        const VertexEntry* const entry = feed.find(window[k]);
        ASSERT_TRUE(entry);
        EXPECT_TRUE(feed.is_current(window[k], entry, format));
        EXPECT_TRUE(bytes_of(*entry) == expected[k].bytes) << window[k];
    }
    l1->release();
}

// Vertices that are made while what they are made by changes are not uploaded: they are made again.
TEST(ChunkFeed, DropsVerticesOfAFormerSelection)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = coloured_cube(folder);
    const auto l1 = std::make_shared<L1Cache>();
    ChunkFeed feed(cloud, l1);
    const Wakes wakes(feed);
    std::string notice;
    CloudStyle style = fitted_style();
    style.colour = ColourMode::uniform;
    const VertexFormat format = feed.format_of(style, {}, notice);
    const auto frame = [&] {
        feed.begin_frame();
        l1->begin_frame(feed.owner());
        feed.load({0}, {}, format);
        return feed.upload({0}, format, 1000).uploaded;
    };
    EXPECT_EQ(frame(), 0u);
    ASSERT_TRUE(wakes.come(1));
    auto selected = std::make_shared<PointSet>(cloud->tree());
    selected->set(0, {3});
    feed.select(selected);
    EXPECT_EQ(frame(), 0u);
    ASSERT_TRUE(wakes.come(2));
    EXPECT_EQ(frame(), 1u);
    EXPECT_EQ(feed.find(0)->selection, selection_number(*selected, 0));
    // The same after a release, which is called when points have changed.
    feed.release();
    EXPECT_EQ(frame(), 0u);
    l1->release();
}

// Nodes that will be wanted have their vertices before: they are uploaded in the first frame that wants them, and their
// arrival wakes no one.
TEST(ChunkFeed, UploadsWhatWasMadeAheadAtOnce)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = coloured_cube(folder);
    const auto l1 = std::make_shared<L1Cache>();
    ChunkFeed feed(cloud, l1);
    const Wakes wakes(feed);
    std::string notice;
    CloudStyle style = fitted_style();
    style.colour = ColourMode::uniform;
    const VertexFormat format = feed.format_of(style, {}, notice);
    const auto frame = [&](const std::vector<NodeId>& window, const std::vector<NodeId>& ahead) {
        feed.begin_frame();
        l1->begin_frame(feed.owner());
        feed.load(window, ahead, format);
        return feed.upload(window, format, 1000).uploaded;
    };
    EXPECT_EQ(frame({}, {1, 2}), 0u);
    cloud->cache().wait_idle();
    EXPECT_EQ(wakes.count(), 0);
    EXPECT_FALSE(feed.waits());
    EXPECT_EQ(frame({1}, {2}), 1u);
    EXPECT_EQ(frame({2}, {}), 1u);
    // One that is made ahead and wanted meanwhile wakes the owner, whichever of the two comes first.
    EXPECT_EQ(frame({}, {3}), 0u);
    feed.load({3}, {}, format);
    for (int tries = 0; tries < 500 && feed.waits(); ++tries) {
        if (wakes.count() > 0) feed.load({3}, {}, format);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_EQ(frame({3}, {}), 1u);
    l1->release();
}
