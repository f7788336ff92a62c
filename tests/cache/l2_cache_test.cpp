// The cache against a naive model, from one thread and from many, and over a damaged tree.

#include "pcm/cache/l2_cache.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "tests/cache/l2_cloud.h"
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
