#include "pcm/query/chunk_stream.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/failing_threads.h"
#include "tests/support.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>
#include <set>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

// A tree whose reads are counted, held up, and made to fail.
class WatchedStore final : public ChunkStore {
public:
    explicit WatchedStore(std::shared_ptr<const Tree> tree) : below_(std::move(tree)) {}
    std::shared_ptr<const Tree> tree() const override { return below_.tree(); }
    Chunk read(NodeId node, const ColumnSet& columns) const override
    {
        const Watched watched(*this, node);
        return below_.read(node, columns);
    }
    ChunkPart read_part(NodeId node, const ColumnSet& columns,
                        const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const override
    {
        const Watched watched(*this, node);
        return below_.read_part(node, columns, wanted);
    }

    void fail(NodeId node) { failing_ = node; }
    void hold()
    {
        const std::lock_guard lock(mutex_);
        held_ = true;
    }
    void release()
    {
        {
            const std::lock_guard lock(mutex_);
            held_ = false;
        }
        changed_.notify_all();
    }
    // Waits until `reads` reads have begun; false when they have not after ten seconds.
    bool wait_for_begun(std::size_t reads) const
    {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(10), [&] { return begun_ >= reads; });
    }
    std::size_t begun() const
    {
        const std::lock_guard lock(mutex_);
        return begun_;
    }
    std::size_t most_at_once() const
    {
        const std::lock_guard lock(mutex_);
        return most_at_once_;
    }
    std::set<std::thread::id> readers() const
    {
        const std::lock_guard lock(mutex_);
        return readers_;
    }

private:
    struct Watched {
        Watched(const WatchedStore& of, NodeId node) : store(of)
        {
            std::unique_lock lock(store.mutex_);
            ++store.begun_;
            store.most_at_once_ = std::max(store.most_at_once_, ++store.running_);
            store.readers_.insert(std::this_thread::get_id());
            store.changed_.notify_all();
            store.changed_.wait(lock, [&] { return !store.held_; });
            if (node == store.failing_) {
                --store.running_;
                throw Error(ErrorCode::io, "the disk", "node " + std::to_string(node));
            }
        }
        ~Watched()
        {
            const std::lock_guard lock(store.mutex_);
            --store.running_;
        }
        const WatchedStore& store;
    };

    TreeStore below_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    mutable std::size_t begun_ = 0, running_ = 0, most_at_once_ = 0;
    mutable std::set<std::thread::id> readers_;
    bool held_ = false;
    NodeId failing_ = no_node;
};

struct Found {
    NodeId node;
    std::uint32_t number;
    Vec3i position;
    double intensity;
    bool operator==(const Found& o) const
    {
        return node == o.node && number == o.number && position == o.position && intensity == o.intensity;
    }
};

class ChunkStreamTest : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::volume, 30000, 3), {{0.01, 0.01, 0.01}, {5e6, 4.8e6, 0}});
        BuildOptions options;
        options.chunk_points = 1000;
        build_tree({folder_ / "in.las"}, folder_ / "t.pct", options);
        tree_ = Tree::open(folder_ / "t.pct");
        intensity_ = *tree_->info().schema.find("intensity");
        columns_.attributes.set(intensity_);
        for (NodeId id = 0; id < tree_->nodes().size(); ++id)
            if (tree_->node(id).points) with_points_.push_back(id);
        ASSERT_GT(with_points_.size(), 30u);
    }

    // The oracle: every chunk of the tree decoded, every point tested.
    std::vector<Found> selected(const Selection& selection, const std::optional<std::uint16_t>& level) const
    {
        std::vector<Found> found;
        for (NodeId id = 0; id < tree_->nodes().size(); ++id) {
            const Node& node = tree_->node(id);
            const Chunk chunk = tree_->read_chunk(id, ColumnSet::all(tree_->info().schema));
            for (std::uint32_t i = 0; i < (level ? node.points_to_level(*level) : node.points); ++i) {
                const Vec3i grid = chunk.positions->grid(i);
                const Vec3d at = tree_->info().grid.to_source(grid);
                const double intensity = chunk.attributes[intensity_]->value(i);
                bool holds = !selection.box || selection.box->contains(at);
                holds = holds && (!selection.region || selection.region->contains(at));
                if (!selection.where.empty()) holds = holds && intensity > 30000;
                if (holds) found.push_back({id, i, grid, intensity});
            }
        }
        return found;
    }

    std::unique_ptr<ChunkStream> stream(const Selection& selection, unsigned in_flight,
                                        const std::optional<std::uint16_t>& level = {})
    {
        return std::make_unique<ChunkStream>(*cache_, pool_, rates_, Selector(selection, tree_->info().schema), level,
                                             columns_, in_flight);
    }
    void open(std::uint64_t cache_bytes)
    {
        store_ = std::make_shared<WatchedStore>(tree_);
        L2Options options;
        options.capacity_bytes = cache_bytes;
        cache_ = std::make_unique<L2Cache>(store_, options);
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::size_t intensity_ = 0;
    ColumnSet columns_;
    std::vector<NodeId> with_points_;
    std::shared_ptr<WatchedStore> store_;
    std::unique_ptr<L2Cache> cache_;
    ReadRates rates_;
    TaskPool pool_;
};

TEST_F(ChunkStreamTest, GivesTheSelectedPointsOfEveryChunkInOrder)
{
    const Box3d bounds = tree_->info().bounds();
    const Vec3d centre = bounds.centre();
    std::vector<Selection> selections(5);
    selections[1].box = Box3d{bounds.min, centre};
    selections[2].region = Region::sphere(centre, 0.3 * bounds.diagonal());
    selections[3].where = {parse_condition("intensity>30000")};
    selections[4].box = Box3d{centre, bounds.max};
    selections[4].where = {parse_condition("intensity>30000")};
    const auto middle = static_cast<std::uint16_t>(tree_->info().levels / 2);
    for (const Selection& selection : selections)
        for (const std::optional<std::uint16_t>& level : {std::optional<std::uint16_t>(), std::optional(middle)}) {
            const std::vector<Found> wanted = selected(selection, level);
            ASSERT_FALSE(wanted.empty());
            for (const std::uint64_t cache_bytes : {std::uint64_t{20000}, std::uint64_t{100} << 20}) {
                open(cache_bytes);
                for (const unsigned in_flight : {0u, 1u, 2u, 8u, 1000u}) {  // later ones find chunks in the cache
                    const auto chunks = stream(selection, in_flight, level);
                    std::vector<Found> found;
                    while (const SelectedChunk* chunk = chunks->next()) {
                        ASSERT_GT(chunk->size(), 0u);
                        for (std::size_t i = 0; i < chunk->size(); ++i) {
                            const std::size_t at = chunk->index(i);
                            found.push_back({chunk->node, chunk->number(at), chunk->chunk.positions->grid(at),
                                             chunk->chunk.attributes[intensity_]->value(at)});
                        }
                    }
                    ASSERT_TRUE(found == wanted) << found.size() << " points, expected " << wanted.size();
                    EXPECT_EQ(chunks->fraction(), 1);
                    EXPECT_EQ(chunks->chunks(), chunks->nodes().size());
                    EXPECT_GE(chunks->points_read(), wanted.size());
                    EXPECT_EQ(chunks->next(), nullptr);
                }
            }
        }
}

// Reading everything once pushes nothing out of a cache that is less than four times as large.
TEST_F(ChunkStreamTest, KeepsChunksOnlyWhereAllTakeLittleOfTheCache)
{
    std::uint64_t bytes = 0;
    for (const Node& node : tree_->nodes()) bytes += node.points * decoded_bytes(*tree_, columns_);
    for (const bool keeps : {true, false}) {
        open(4 * bytes - (keeps ? 0 : 4));
        const NodeId held = with_points_.back();
        cache_->get(held, columns_);
        for (const bool again : {false, true}) {
            const auto chunks = stream({}, 3);
            std::size_t points = 0;
            while (const SelectedChunk* chunk = chunks->next()) points += chunk->size();
            EXPECT_EQ(points, tree_->info().points);
            EXPECT_EQ(chunks->cached(), keeps && again ? with_points_.size() : 1u) << "the chunk that was there before";
            EXPECT_EQ(chunks->bytes_read() > 0, !keeps);
        }
        EXPECT_EQ(cache_->statistics().resident_chunks, keeps ? with_points_.size() : 1u);
        EXPECT_TRUE(cache_->find(held, columns_));
    }
}

TEST_F(ChunkStreamTest, ReadsAheadUpToTheBoundAndNoFurther)
{
    for (const unsigned in_flight : {1u, 3u, 8u}) {
        open(std::uint64_t{100} << 20);
        const auto chunks = stream({}, in_flight);
        for (std::size_t given = 1; given <= 10; ++given) {
            ASSERT_NE(chunks->next(), nullptr);
            const std::size_t bound = given + in_flight - 1;
            ASSERT_TRUE(store_->wait_for_begun(bound)) << "reads ahead stopped at " << store_->begun();
            ASSERT_EQ(store_->begun(), bound);
        }
        EXPECT_LE(store_->most_at_once(), in_flight);
    }
}

TEST_F(ChunkStreamTest, ReadsRunAtOnce)
{
    open(std::uint64_t{100} << 20);
    const auto chunks = stream({}, 4);
    store_->hold();
    auto first = std::async(std::launch::async, [&] { return chunks->next() != nullptr; });
    EXPECT_TRUE(store_->wait_for_begun(4));
    store_->release();
    EXPECT_TRUE(first.get());
    EXPECT_EQ(store_->most_at_once(), 4u);
}

TEST_F(ChunkStreamTest, DroppedInTheMiddleItWaitsForTheReadsThatRunAndStartsNoOther)
{
    open(std::uint64_t{100} << 20);
    auto chunks = stream({}, 4);
    ASSERT_NE(chunks->next(), nullptr);
    ASSERT_TRUE(store_->wait_for_begun(4));
    store_->hold();
    auto next = std::async(std::launch::async, [&] { chunks->next(); });
    next.get();  // what was read ahead; one more is read now, and held
    ASSERT_TRUE(store_->wait_for_begun(5));
    auto dropped = std::async(std::launch::async, [&] { chunks.reset(); });
    EXPECT_EQ(dropped.wait_for(std::chrono::milliseconds(30)), std::future_status::timeout);
    store_->release();
    dropped.get();
    EXPECT_EQ(store_->begun(), 5u);

    // The cache and the pool serve the next stream.
    const auto again = stream({}, 4);
    std::size_t count = 0;
    while (again->next()) ++count;
    EXPECT_EQ(count, with_points_.size());
}

TEST_F(ChunkStreamTest, AnErrorComesInItsPlaceAndTheNextCallResumesBehindIt)
{
    Selection box;
    box.box = Box3d{tree_->info().bounds().min, tree_->info().bounds().centre()};
    for (const Selection& selection : {Selection(), box})
        for (const unsigned in_flight : {1u, 8u}) {
            open(20000);
            std::vector<NodeId> expected;
            for (const auto chunks = stream(selection, 1); const SelectedChunk* chunk = chunks->next();)
                expected.push_back(chunk->node);
            ASSERT_GT(expected.size(), 6u);
            const std::size_t middle = expected.size() / 2;
            open(20000);
            store_->fail(expected[middle]);
            const auto chunks = stream(selection, in_flight);
            std::vector<NodeId> given;
            std::size_t errors = 0;
            for (bool more = true; more;) try {
                    const SelectedChunk* chunk = chunks->next();
                    more = chunk != nullptr;
                    if (more) given.push_back(chunk->node);
                } catch (const Error& error) {
                    ++errors;
                    EXPECT_EQ(error.code(), ErrorCode::io);
                    EXPECT_NE(std::string(error.what()).find("node " + std::to_string(expected[middle])),
                              std::string::npos);
                    EXPECT_EQ(given, std::vector<NodeId>(expected.begin(), expected.begin() + long(middle)));
                }
            EXPECT_EQ(errors, 1u);
            std::vector<NodeId> others = expected;
            others.erase(others.begin() + long(middle));
            EXPECT_EQ(given, others);
        }
}

TEST_F(ChunkStreamTest, WithoutFurtherThreadsTheCallerReadsEverything)
{
    open(std::uint64_t{100} << 20);
    const FailingThreads none(0);
    const auto chunks = stream({}, 8);
    std::size_t count = 0;
    while (chunks->next()) ++count;
    EXPECT_EQ(count, with_points_.size());
    EXPECT_EQ(store_->readers(), std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
