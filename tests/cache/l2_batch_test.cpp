// Chunks that the cache reads together, because they lie next to each other on disk.

#include "pcm/cache/chunk_store.h"
#include "pcm/system/work_done.h"
#include "tests/cache/l2_cloud.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

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

}  // namespace
