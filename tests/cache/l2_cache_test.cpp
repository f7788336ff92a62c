// The cache against a naive model, from one thread and from many, and over a damaged tree.

#include "pcm/cache/l2_cache.h"

#include "pcm/bpc/chunk_bytes.h"
#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "pcm/system/work_done.h"
#include "tests/clouds.h"
#include "tests/failing_threads.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <atomic>
#include <condition_variable>
#include <fstream>
#include <list>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

class L2CacheTest : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 60000, 3), {});
        BuildOptions options;
        options.chunk_points = 1000;
        options.threads = 2;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
        tree_ = Tree::open(folder_ / "out.pct");
        ASSERT_GT(tree_->nodes().size(), 60u);
        intensity_.attributes.set(*tree_->info().schema.find("intensity"));
        colour_.attributes.set(*tree_->info().schema.find("rgb"));
    }
    std::size_t bytes_of(NodeId node, const ColumnSet& columns) const
    {
        std::size_t bytes = (columns.positions ? 12 : 0) + (columns.sizes ? 1 : 0);
        for (std::size_t i = 0; i < tree_->info().schema.size(); ++i)
            if (columns.attributes.test(i)) bytes += tree_->info().schema[i].bytes();
        return bytes * tree_->node(node).points;
    }

    // Nodes with points that no read brings together, in the order of their chunks.
    std::vector<NodeId> nodes_read_apart(std::size_t count) const
    {
        std::map<std::uint64_t, NodeId> by_offset;
        for (NodeId id = 0; id < tree_->nodes().size(); ++id)
            if (tree_->node(id).extent.bytes > 0) by_offset[tree_->node(id).extent.offset] = id;
        std::vector<NodeId> nodes;
        std::uint64_t end = 0;
        for (const auto& [offset, id] : by_offset) {
            if (nodes.size() == count || (!nodes.empty() && offset <= end + join_gap)) continue;
            nodes.push_back(id);
            end = offset + tree_->node(id).extent.bytes;
        }
        EXPECT_EQ(nodes.size(), count);
        return nodes;
    }

    // Two nodes whose chunks one read brings.
    std::pair<NodeId, NodeId> nodes_read_together() const
    {
        for (NodeId a = 0; a < tree_->nodes().size(); ++a)
            for (NodeId b = 0; b < tree_->nodes().size(); ++b) {
                const Extent &first = tree_->node(a).extent, &second = tree_->node(b).extent;
                if (first.bytes && second.bytes && first.file == second.file &&
                    second.offset == first.offset + first.bytes)
                    return {a, b};
            }
        ADD_FAILURE() << "no two chunks lie next to each other";
        return {};
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    ColumnSet positions_ = ColumnSet::only_positions(), intensity_, colour_;
};

// The promises of the header, in the plainest way.
struct Model {
    struct Entry {
        ColumnSet columns, ever;
        std::size_t bytes = 0, pins = 0;
        bool resident = false, known = false;
    };
    std::map<NodeId, Entry> entries;
    std::list<NodeId> unpinned;  // least recently used first
    std::size_t charged = 0, capacity = 0;
    std::uint64_t hits = 0, compulsory = 0, capacity_misses = 0, evictions = 0;

    void shrink()
    {
        while (charged > capacity && !unpinned.empty()) {
            Entry& e = entries[unpinned.front()];
            unpinned.pop_front();
            charged -= e.bytes;
            e.bytes = 0;
            e.resident = false;
            ++evictions;
        }
    }
    void pin(NodeId node)
    {
        unpinned.remove(node);
        ++entries[node].pins;
    }
    void unpin(NodeId node)
    {
        if (--entries[node].pins == 0 && entries[node].resident) {
            unpinned.push_back(node);
            shrink();
        }
    }
};

TEST_F(L2CacheTest, RandomOperationsAgainstAModel)
{
    std::mt19937_64 random(4);
    L2Options options;
    options.capacity_bytes = 400000;
    L2Cache cache(tree_, options);
    Model model;
    model.capacity = options.capacity_bytes;
    std::vector<std::pair<NodeId, L2Cache::Handle>> held;
    ColumnSet with_sizes = colour_;
    with_sizes.sizes = true;
    const std::vector<ColumnSet> wishes = {positions_, intensity_, colour_, with_sizes};
    std::vector<NodeId> nodes;
    for (NodeId id = 0; id < tree_->nodes().size(); ++id)
        if (tree_->node(id).points) nodes.push_back(id);
    for (int i = 0; i < tries(100000, 20000); ++i) {
        // Some nodes are asked for more often than others.
        const NodeId node = nodes[std::min(random() % nodes.size(), random() % nodes.size())];
        const ColumnSet& columns = wishes[random() % wishes.size()];
        Model::Entry& entry = model.entries[node];
        const bool there = entry.resident && entry.columns.contains(columns);
        switch (random() % 8) {
            case 0: {
                const auto handle = cache.find(node, columns);
                ASSERT_EQ(static_cast<bool>(handle), there);
                if (there) {
                    ++model.hits;
                    model.pin(node);
                    model.unpin(node);
                }
                break;
            }
            case 1:
                if (!held.empty()) {
                    const std::size_t k = random() % held.size();
                    const NodeId freed = held[k].first;
                    held.erase(held.begin() + static_cast<std::ptrdiff_t>(k));
                    model.unpin(freed);
                }
                break;
            case 2:
                if (random() % 50 == 0) {
                    cache.clear();
                    while (!model.unpinned.empty()) {
                        Model::Entry& e = model.entries[model.unpinned.front()];
                        model.unpinned.pop_front();
                        model.charged -= e.bytes;
                        e.bytes = 0;
                        e.resident = false;
                        ++model.evictions;
                    }
                } else if (random() % 50 == 0) {
                    model.capacity = 100000 + random() % 600000;
                    cache.set_capacity(model.capacity);
                    model.shrink();
                }
                break;
            default: {
                auto handle = cache.get(node, columns);
                ASSERT_EQ(handle->points, tree_->node(node).points);
                ASSERT_TRUE(handle->columns().contains(columns));
                if (there) {
                    ++model.hits;
                } else {
                    ++(entry.known && entry.ever.contains(columns) ? model.capacity_misses : model.compulsory);
                    if (!entry.resident) {
                        entry.columns = ColumnSet();
                        entry.columns.positions = false;
                    }
                    entry.columns |= columns;
                    if (!entry.known) entry.ever = entry.columns;
                    entry.ever |= entry.columns;
                    entry.known = true;
                    entry.resident = true;
                    model.charged -= entry.bytes;
                    entry.bytes = bytes_of(node, entry.columns);
                    model.charged += entry.bytes;
                }
                model.pin(node);
                model.shrink();
                if (held.size() < 10 && random() % 3 == 0) {
                    held.emplace_back(node, std::move(handle));
                } else {
                    handle = L2Cache::Handle();
                    model.unpin(node);
                }
            }
        }
        if (i % 100 == 0) {
            const L2Statistics statistics = cache.statistics();
            ASSERT_EQ(statistics.resident_bytes, model.charged) << i;
            ASSERT_EQ(statistics.hits, model.hits) << i;
            ASSERT_EQ(statistics.compulsory_misses, model.compulsory) << i;
            ASSERT_EQ(statistics.capacity_misses, model.capacity_misses) << i;
            ASSERT_EQ(statistics.forced_misses, model.compulsory + model.capacity_misses) << i;
            ASSERT_EQ(statistics.evictions, model.evictions) << i;
        }
    }
    EXPECT_GT(model.hits, 1000u);
    EXPECT_GT(model.capacity_misses, 1000u);
}

TEST_F(L2CacheTest, ManyThreadsSeeTheRightPoints)
{
    L2Options options;
    options.capacity_bytes = 300000;
    options.threads = 2;
    L2Cache cache(tree_, options);
    std::atomic<int> wrong{0};
    std::vector<std::thread> clients;
    for (unsigned t = 0; t < 4; ++t)
        clients.emplace_back([&, t] {
            std::mt19937_64 random(t);
            for (int i = 0; i < 1500; ++i) {
                const auto node = static_cast<NodeId>(random() % tree_->nodes().size());
                if (random() % 10 == 0) {
                    std::vector<ChunkRequest> list;
                    for (int k = 0; k < 8; ++k)
                        list.push_back({static_cast<NodeId>(random() % tree_->nodes().size()), positions_});
                    cache.request(std::move(list));
                    continue;
                }
                const auto handle = cache.get(node, random() % 2 ? positions_ : colour_);
                if (handle->points != tree_->node(node).points) ++wrong;
                for (std::size_t k = 0; k < handle->points; k += 100)
                    if (!tree_->node(node).box.contains(handle->positions->grid(k))) ++wrong;
            }
        });
    for (std::thread& client : clients) client.join();
    cache.wait_idle();
    EXPECT_EQ(wrong, 0);
    EXPECT_LE(cache.statistics().resident_bytes, options.capacity_bytes);
}

TEST_F(L2CacheTest, AChunkIsLoadedOnceForManyClients)
{
    L2Cache cache(tree_);
    std::vector<std::thread> clients;
    for (int t = 0; t < 8; ++t)
        clients.emplace_back([&] {
            for (NodeId id = 0; id < tree_->nodes().size(); ++id) cache.get(id, positions_);
        });
    for (std::thread& client : clients) client.join();
    std::uint64_t bytes = 0;
    for (NodeId id = 0; id < tree_->nodes().size(); ++id) bytes += bytes_of(id, positions_);
    EXPECT_EQ(cache.statistics().loaded_bytes, bytes);
}

// A callback may ask for any chunk, also one that was read together with its own; and one thread serves all.
TEST_F(L2CacheTest, CallbacksOfChunksThatAreReadTogetherMayAskForEachOther)
{
    L2Options options;
    options.capacity_bytes = 1;  // nothing stays
    L2Cache cache(tree_, options);
    std::vector<ChunkRequest> list;
    for (NodeId id = 0; id < tree_->nodes().size(); ++id) list.push_back({id, positions_});
    std::mutex mutex;
    std::vector<NodeId> arrived;
    const WorkDone before = work_done();
    cache.request(list, [&](NodeId node) {
        EXPECT_TRUE(cache.find(node, positions_)) << "pinned while it is handed over";
        const std::lock_guard lock(mutex);
        arrived.push_back(node);
        if (arrived.size() % 8 == 0) cache.get((node + 1) % static_cast<NodeId>(tree_->nodes().size()), positions_);
    });
    cache.wait_idle();
    EXPECT_EQ(arrived.size(), list.size());
    EXPECT_LT((work_done() - before).reads, list.size() / 2) << "chunks near each other come in one read";
    std::sort(arrived.begin(), arrived.end());
    EXPECT_TRUE(std::unique(arrived.begin(), arrived.end()) == arrived.end()) << "each once";
    EXPECT_EQ(cache.statistics().resident_bytes, 0u);
}

TEST_F(L2CacheTest, RequestsAreServedInOrderAndReplaced)
{
    L2Cache cache(tree_);
    std::mutex mutex;
    std::condition_variable wake;
    std::vector<NodeId> arrived;
    bool open = false;
    const auto gate = [&](NodeId node) {
        std::unique_lock lock(mutex);
        arrived.push_back(node);
        wake.notify_all();
        wake.wait(lock, [&] { return open; });
    };
    const std::vector<NodeId> apart = nodes_read_apart(5);
    cache.request({{apart[0], positions_}, {apart[1], positions_}, {apart[2], positions_}}, gate);
    {
        std::unique_lock lock(mutex);
        wake.wait(lock, [&] { return !arrived.empty(); });
    }
    // The loader waits in the first callback; requests that it has not begun are forgotten.
    cache.request({{apart[3], positions_}, {apart[4], positions_}}, gate);
    {
        const std::lock_guard lock(mutex);
        open = true;
    }
    wake.notify_all();
    cache.wait_idle();
    EXPECT_EQ(arrived, (std::vector<NodeId>{apart[0], apart[3], apart[4]}));
    EXPECT_FALSE(cache.find(apart[1], positions_));
    EXPECT_TRUE(cache.find(apart[4], positions_));
}

// What is in memory already is not read again with what lies next to it.
TEST_F(L2CacheTest, NeighboursInMemoryAreNotReadAgain)
{
    const auto [first, second] = nodes_read_together();
    L2Cache cache(tree_);
    cache.get(second, positions_);
    const std::uint64_t before = tree_->reads().chunks;
    std::atomic<int> called{0};
    cache.request({{first, positions_}, {second, positions_}}, [&](NodeId) { ++called; });
    cache.wait_idle();
    EXPECT_EQ(called, 2);
    EXPECT_EQ(tree_->reads().chunks - before, 1u);
}

// A store whose reads wait until they are let through.
class GatedStore final : public ChunkStore {
public:
    explicit GatedStore(std::shared_ptr<const Tree> tree) : tree_(std::move(tree)) {}
    std::shared_ptr<const Tree> tree() const override { return tree_; }
    Chunk read(NodeId node, const ColumnSet& columns) const override
    {
        std::unique_lock lock(mutex_);
        waits_ = true;
        wake_.notify_all();
        wake_.wait(lock, [&] { return open_; });
        return tree_->read_chunk(node, columns);
    }
    ChunkPart read_part(NodeId, const ColumnSet&,
                        const std::function<bool(const Box3i&, std::uint16_t)>&) const override
    {
        return {};
    }
    void wait_for_a_read() const
    {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [&] { return waits_; });
    }
    void open()
    {
        const std::lock_guard lock(mutex_);
        open_ = true;
        wake_.notify_all();
    }

private:
    const std::shared_ptr<const Tree> tree_;
    mutable std::mutex mutex_;
    mutable std::condition_variable wake_;
    mutable bool waits_ = false;
    bool open_ = false;
};

// A loader that waits for another client's load serves its own list; what has come meanwhile is the next list's.
TEST_F(L2CacheTest, EveryListHasItsOwnCallback)
{
    const auto [first, second] = nodes_read_together();
    const auto store = std::make_shared<GatedStore>(tree_);
    L2Cache cache(store);
    std::thread client([&cache, node = first, columns = positions_] { cache.get(node, columns); });
    store->wait_for_a_read();
    std::atomic<int> of_old{0}, of_new{0};
    cache.request({{first, colour_}}, [&, wanted = first](NodeId node) { of_old += node == wanted ? 1 : 100; });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // the loader has taken the request, and waits
    cache.request({{second, positions_}}, [&, wanted = second](NodeId node) { of_new += node == wanted ? 1 : 100; });
    store->open();
    client.join();
    cache.wait_idle();
    EXPECT_EQ(of_old, 1);
    EXPECT_EQ(of_new, 1);
}

TEST_F(L2CacheTest, ErrorsReachTheCaller)
{
    // Damage one chunk in the middle of its positions.
    const NodeId victim = 3;
    const Extent extent = tree_->node(victim).extent;
    char name[32];
    std::snprintf(name, sizeof name, "chunks-%03u.bpc", extent.file);
    {
        std::fstream file(folder_ / "out.pct" / name, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(extent.offset + extent.header_bytes + 40));
        file.put('!').put('?').put('!');
    }
    L2Cache cache(tree_);
    for (int i = 0; i < 2; ++i) {
        try {
            cache.get(victim, positions_);
            ADD_FAILURE() << "damage was not noticed";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::corrupt);
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
    std::atomic<int> called{0};
    cache.request({{victim, positions_}, {victim + 1, positions_}}, [&](NodeId) { ++called; });
    cache.wait_idle();
    EXPECT_EQ(called, 2);
    ASSERT_TRUE(cache.error_of(victim));
    EXPECT_NE(cache.error_of(victim)->find("checksum"), std::string::npos);
    EXPECT_FALSE(cache.error_of(victim + 1));
    EXPECT_EQ(cache.statistics().failed_loads, 3u);
    // Other columns of the same chunk are whole and still available.
    EXPECT_EQ(cache
                  .get(victim,
                       [&] {
                           ColumnSet only = colour_;
                           only.positions = false;
                           return only;
                       }())
                  ->points,
              tree_->node(victim).points);
    EXPECT_THROW(cache.get(static_cast<NodeId>(tree_->nodes().size()), positions_), Error);
}

// on_loaded is called for every requested chunk, also for one that is resident or that another client is loading.
TEST_F(L2CacheTest, EveryRequestedChunkIsAnnounced)
{
    L2Cache cache(tree_);
    std::atomic<bool> stop{false};
    std::thread other([&] {
        for (NodeId id = 0; !stop; id = (id + 1) % static_cast<NodeId>(tree_->nodes().size())) {
            cache.get(id, positions_);
            if (id == 0) cache.clear();
        }
    });
    for (int round = 0; round < 200; ++round) {
        std::vector<ChunkRequest> list;
        for (NodeId id = 0; id < 20; ++id) list.push_back({id, positions_});
        std::atomic<int> announced{0};
        cache.request(list, [&](NodeId) { ++announced; });
        while (announced < 20) std::this_thread::yield();
        cache.wait_idle();
    }
    stop = true;
    other.join();
}

// A view that loads chunks through a cache too small for any of them would else wait for ever.
TEST_F(L2CacheTest, ARequestedChunkIsThereWhenItIsAnnouncedHoweverSmallTheCapacity)
{
    L2Options options;
    options.capacity_bytes = 1;
    L2Cache cache(tree_, options);
    std::atomic<int> found{0};
    cache.request({{0, positions_}, {1, positions_}},
                  [&](NodeId node) { found += bool(cache.find(node, positions_)); });
    cache.wait_idle();
    EXPECT_EQ(found, 2);
    EXPECT_EQ(cache.statistics().resident_bytes, 0u);
}

TEST_F(L2CacheTest, HandlesOutliveTheCache)
{
    L2Cache::Handle handle;
    {
        L2Cache cache(tree_);
        handle = cache.get(0, positions_);
    }
    EXPECT_EQ(handle->positions->size(), tree_->node(0).points);
}

TEST_F(L2CacheTest, WorksWithFewerThreadsThanItAskedFor)
{
    L2Options options;
    options.threads = 4;
    for (int allowed = 1; allowed < 4; ++allowed) {
        std::unique_ptr<L2Cache> cache;
        {
            const FailingThreads failing(allowed);
            cache = std::make_unique<L2Cache>(tree_, options);
            EXPECT_EQ(failing.refused(), 1);
        }
        std::vector<ChunkRequest> list;
        for (NodeId id = 0; id < 20; ++id) list.push_back({id, positions_});
        cache->request(list);
        cache->wait_idle();
        for (NodeId id = 0; id < 20; ++id) EXPECT_TRUE(cache->find(id, positions_)) << id;
    }
}

TEST_F(L2CacheTest, IsRefusedWithoutAnyThread)
{
    L2Options options;
    options.threads = 3;
    const FailingThreads failing(0);
    try {
        L2Cache cache(tree_, options);
        ADD_FAILURE() << "nobody would load what is requested";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::io);
        EXPECT_NE(std::string(error.what()).find("thread"), std::string::npos) << error.what();
    }
    EXPECT_EQ(failing.refused(), 1);
}

}  // namespace
