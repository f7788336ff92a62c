// Chunks that are changed: many threads whose changes must all arrive, on a store that now and then fails; misuse.

#include "pcm/cache/l2_cache.h"

#include "tests/cache/fake_store.h"

#include <atomic>
#include <map>
#include <random>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

// Every thread adds to counters; in the end no addition is missing, whatever fails on the way.
TEST_F(L2Changes, ChangesOfManyThreadsAllArrive)
{
    L2Options options;
    options.capacity_bytes = 40000;
    options.threads = 2;
    L2Cache cache(store_, options);
    constexpr std::size_t nodes = 10;
    std::array<std::atomic<std::uint32_t>, nodes> added{};
    std::atomic<bool> done{false};
    std::thread trouble([&] {
        std::mt19937 random(5);
        while (!done) {
            store_->fail_reads = random() % 8 == 0;
            store_->fail_writes = random() % 3 == 0;
            store_->fail_commits = random() % 3 == 0;
            std::this_thread::yield();
            try {
                if (random() % 4 == 0) cache.flush();
            } catch (const Error&) {
            }
        }
    });
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            std::mt19937 random(100 + t);
            for (int changed = 0; changed < 300;) {
                const auto node = static_cast<NodeId>(random() % nodes);
                if (store_->tree()->node(node).points == 0) continue;
                const ColumnSet wanted = columns(random() % 2, random() % 2 ? 1 : 3);
                try {
                    if (random() % 2) {
                        L2Cache::Edit edit = cache.edit(node, wanted);
                        Column& column = edit.column(slots_[0]);
                        Value* const values = column.as<Value>();
                        for (std::size_t p = 1; p < column.size(); ++p) ASSERT_EQ(values[p], values[0]);
                        std::fill_n(values, column.size(), static_cast<Value>(values[0] + 1));
                        edit.mark_written();
                        ++added[node];
                        ++changed;
                    } else {
                        const L2Cache::Handle handle = cache.get(node, wanted);
                        for (const auto& column : handle->attributes)
                            if (column && column == handle->attributes[slots_[0]])
                                for (std::size_t p = 1; p < column->size(); ++p)
                                    ASSERT_EQ(column->as<Value>()[p], column->as<Value>()[0]);
                        if (random() % 4 == 0) cache.prefetch({static_cast<NodeId>(random() % nodes), wanted});
                    }
                } catch (const Error& error) {
                    ASSERT_NE(error.code(), ErrorCode::corrupt);
                    std::this_thread::yield();
                }
            }
        });
    for (std::thread& thread : threads) thread.join();
    done = true;
    trouble.join();
    store_->fail_reads = store_->fail_writes = store_->fail_commits = false;
    cache.flush();
    std::uint32_t sum = 0;
    for (NodeId node = 0; node < nodes; ++node) {
        if (store_->tree()->node(node).points == 0) continue;
        EXPECT_EQ(store_->committed(node, slots_[0]), static_cast<Value>(added[node])) << node;
        sum += added[node];
    }
    EXPECT_EQ(sum, 1200u);
}

// Sizes of points are a column like others: read when they are asked for, once.
TEST_F(L2Changes, OnlyLackingColumnsAreRead)
{
    L2Cache cache(store_, {});
    ColumnSet sizes = columns(true, 0);
    sizes.sizes = true;
    NodeId node = 0;
    while (store_->tree()->node(node).points == 0) ++node;
    ASSERT_TRUE(cache.get(node, sizes)->sizes);
    EXPECT_TRUE(store_->last_asked == sizes);
    ColumnSet more = sizes;
    more |= columns(true, 1);
    EXPECT_TRUE(cache.get(node, more)->sizes);
    EXPECT_TRUE(store_->last_asked == columns(false, 1));
    const std::uint64_t reads = store_->reads;
    EXPECT_TRUE(cache.find(node, sizes));
    EXPECT_TRUE(cache.find(node, more));
    EXPECT_EQ(store_->reads, reads);
    EXPECT_FALSE(cache.find(node, columns(false, 2)));
}

TEST_F(L2Changes, MisuseIsReported)
{
    L2Cache cache(store_, {});
    const auto code_of = [](const auto& call) {
        try {
            call();
        } catch (const Error& error) {
            return error.code();
        }
        return ErrorCode::cancelled;
    };
    std::optional<L2Cache::Edit> edit(cache.edit(1, columns(false, 1)));
    EXPECT_EQ(code_of([&] { edit->column(slots_[1]); }), ErrorCode::invalid_argument);  // not asked for
    edit->column(slots_[0]).resize(3);
    EXPECT_EQ(code_of([&] { edit->mark_written(); }), ErrorCode::invalid_argument);
    edit.reset();
    EXPECT_EQ(code_of([&] { cache.flush(); }), ErrorCode::invalid_argument);  // changed and not marked
    cache.flush();
    edit.emplace(cache.edit(1, columns(false, 1)));
    edit->column(slots_[0]);
    cache.close();
    EXPECT_EQ(code_of([&] { edit->mark_written(); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { cache.get(1, columns(true, 0)); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { cache.edit(1, columns(true, 0)); }), ErrorCode::invalid_argument);
    EXPECT_FALSE(cache.find(1, columns(true, 0)));

    L2Cache reading(store_->tree(), {});
    EXPECT_EQ(code_of([&] { reading.edit(1, columns(false, 1)); }), ErrorCode::invalid_argument);
}

// What a call says of a cache that was closed, for reading and for writing, and of nodes that are not there.
TEST_F(L2Changes, ClosedCachesAndMissingNodesAreNamed)
{
    const auto text_of = [](const auto& call) -> std::string {
        try {
            call();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            return error.what();
        }
        return "";
    };
    const auto everything = [](const Box3i&, std::uint16_t) { return true; };
    L2Cache writing(store_, {}), reading(store_->tree(), {});
    const auto missing = static_cast<NodeId>(store_->tree()->nodes().size());
    const std::string nowhere = "no node " + std::to_string(missing) + " in this tree";
    for (L2Cache* cache : {&writing, &reading}) {
        EXPECT_NE(text_of([&] { cache->get(missing, columns(true, 0)); }).find(nowhere), std::string::npos);
        EXPECT_NE(text_of([&] { cache->read_part(missing, columns(true, 0), everything); }).find(nowhere),
                  std::string::npos);
        EXPECT_NE(text_of([&] { cache->edit(missing, columns(false, 1)); }).find(nowhere), std::string::npos);
        EXPECT_EQ(text_of([&] { cache->get(missing - 1, columns(true, 0)); }), "");
    }
    EXPECT_NE(text_of([&] { reading.edit(1, columns(false, 1)); }).find("for reading only (open it for writing)"),
              std::string::npos);
    for (L2Cache* cache : {&writing, &reading}) {
        cache->close();
        const std::string closed = "this point cloud was closed (open it again)";
        EXPECT_NE(text_of([&] { cache->get(1, columns(true, 0)); }).find(closed), std::string::npos);
        EXPECT_NE(text_of([&] { cache->read_part(1, columns(true, 0), everything); }).find(closed), std::string::npos);
        EXPECT_NE(text_of([&] { cache->edit(1, columns(false, 1)); }).find(closed), std::string::npos);
    }
}

}  // namespace
