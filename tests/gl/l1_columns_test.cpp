// Columns in L1: the cache against a naive model, and changed columns read back.
#include "tests/gl/gl_support.h"

#include "pcm/gl/l1/l1_cache.h"
#include "pcm/system/error.h"

#include "tests/gl/l1_settings.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

using namespace pcm;
using namespace pcm::test;

namespace {

using Bytes = std::vector<std::byte>;
using Columns = std::vector<Bytes>;
using Key = std::pair<L1Cache::Owner, NodeId>;

const std::vector<std::uint32_t> strides{12, 4, 7};

Columns random_columns(std::uint32_t points, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    Columns columns;
    for (const std::uint32_t stride : strides) {
        Bytes bytes(std::size_t(points) * stride);
        const auto first = random(), step = random() | 1;
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>((first + i * step) >> 13);
        columns.push_back(std::move(bytes));
    }
    return columns;
}

std::vector<ColumnSource> sources_of(const Columns& columns)
{
    std::vector<ColumnSource> sources;
    for (std::size_t k = 0; k < columns.size(); ++k)
        sources.push_back({strides[k], [&bytes = columns[k], stride = strides[k]](std::byte* to, std::size_t first,
                                                                                  std::size_t count) {
                               std::copy_n(bytes.data() + first * stride, count * stride, to);
                           }});
    return sources;
}

// Does what a shader would do: writes other bytes into the column's buffers.
void change_in_video_memory(const ColumnEntry& entry, std::size_t column, const Bytes& bytes)
{
    for (const ColumnPiece& piece : entry.pieces) {
        const BufferRange& range = piece.columns[column];
        glBindBuffer(GL_COPY_WRITE_BUFFER, range.buffer);
        glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(range.offset), static_cast<GLsizeiptr>(range.bytes),
                        bytes.data() + std::size_t(piece.first) * entry.strides[column]);
    }
}

// An owner's store, whose disk fails at some nodes for a while.
struct FaultyStore final : L1WriteBack {
    const std::set<NodeId>* broken = nullptr;
    std::map<NodeId, std::map<std::size_t, Bytes>> stored;
    std::uint64_t bytes = 0;
    void write(NodeId node, const ChangedColumns& changed) override
    {
        std::map<std::size_t, Bytes> read;
        for (const std::size_t k : changed.columns()) {
            read[k].resize(std::size_t(changed.points()) * strides[k]);
            changed.read(k, read[k].data());
            if (broken && broken->count(node))
                throw Error(ErrorCode::no_space, "/cloud", "node " + std::to_string(node));
        }
        for (auto& [k, column] : read) {
            bytes += column.size();
            stored[node][k] = std::move(column);
        }
    }
};

class L1ColumnsWith : public testing::TestWithParam<L1Setting> {};
INSTANTIATE_TEST_SUITE_P(Settings, L1ColumnsWith, testing::ValuesIn(l1_settings),
                         [](const auto& setting) { return name_of(setting.param); });

}  // namespace

TEST_P(L1ColumnsWith, RandomChangesOfColumnsComeBackByteForByte)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(13);
    L1Options options = options_of(GetParam());
    L1Cache cache(options);
    L1Model model = model_of(options);
    std::set<NodeId> broken;
    model.write_back = [&](const L1Model::Entry& e) { return !broken.count(e.node); };
    std::map<L1Cache::Owner, std::shared_ptr<FaultyStore>> stores;
    std::vector<L1Cache::Owner> owners;
    const auto add_owner = [&] {
        auto store = std::make_shared<FaultyStore>();
        store->broken = &broken;
        const auto owner = cache.add_owner(store);
        stores[owner] = store;
        model.latest[owner] = 0;
        return owner;
    };
    for (int i = 0; i < 2; ++i) owners.push_back(add_owner());
    std::map<Key, Columns> shadow;  // the latest uploads with later changes
    std::map<L1Cache::Owner, std::map<NodeId, std::map<std::size_t, Bytes>>> marked;
    const std::vector<std::uint32_t> sizes{1, 255, 256, 257, 5120, 5121, 0, 30000};
    std::uint64_t refused_by_store = 0, failed_flushes = 0, failed_shrinks = 0;

    for (std::uint64_t step = 0; step < 10000; ++step) {
        auto& owner = owners[random() % owners.size()];
        const auto node = static_cast<NodeId>(random() % 30);
        const std::uint64_t action = random() % 1000;
        if (action < 80) {
            cache.begin_frame(owner);
            model.latest[owner] = ++model.frame;
        } else if (action < 350) {
            ASSERT_EQ(cache.use_columns(owner, node) != nullptr, model.use(owner, node)) << "step " << step;
        } else if (action < 600) {
            const std::uint32_t points = sizes[random() % sizes.size()];
            std::size_t pages = 0;
            for (const std::uint32_t stride : strides) pages += L1Cache::pages_of(stride, points);
            Columns columns = random_columns(points, step);
            const bool done = model.insert(owner, node, pages, 0, step % 2 != 0);
            ASSERT_EQ(
                cache.upload_columns(owner, node, points, {1, 2, 3}, sources_of(columns), step % 2 != 0) != nullptr,
                done)
                << "step " << step;
            if (done) shadow[{owner, node}] = std::move(columns);
            if (!done && cache.write_back_error()) ++refused_by_store;
        } else if (action < 850) {
            const ColumnEntry* const entry = cache.find_columns(owner, node);
            if (entry) {
                const std::size_t k = random() % strides.size();
                Bytes bytes = random_columns(entry->points, step)[k];
                change_in_video_memory(*entry, k, bytes);
                cache.mark_written(owner, node, k);
                model.find(owner, node)->written = true;
                shadow[{owner, node}][k] = bytes;
                marked[owner][node][k] = std::move(bytes);
            }
        } else if (action < 930) {
            if (!broken.erase(node) && broken.size() < 8) broken.insert(node);
        } else if (action < 960) {
            const bool fails = model.flush(&owner) > 0;
            if (fails)
                EXPECT_THROW(cache.flush(owner), Error) << "step " << step;
            else
                EXPECT_NO_THROW(cache.flush(owner)) << "step " << step;
            failed_flushes += fails;
        } else if (action < 990) {
            const auto blocks = static_cast<std::uint32_t>(2 + random() % 4);
            const bool done = model.set_blocks(blocks);
            if (done)
                EXPECT_NO_THROW(cache.set_capacity(blocks * options.block_bytes + 5)) << "step " << step;
            else
                EXPECT_THROW(cache.set_capacity(blocks * options.block_bytes + 5), Error) << "step " << step;
            failed_shrinks += !done;
        } else {
            cache.remove_owner(owner);
            model.remove_owner(owner);
            owner = add_owner();
        }
        ASSERT_EQ(cache.statistics().resident_bytes, model.pages_in_use() * L1Cache::page_bytes) << "step " << step;
        ASSERT_LE(cache.statistics().allocated_bytes, cache.options().capacity_bytes);
        if (step % 100 == 0)
            for (const auto& e : model.entries) {
                const ColumnEntry* const entry = cache.find_columns(e.owner, e.node);
                ASSERT_TRUE(entry) << "step " << step;
                const Columns& expected = shadow.at({e.owner, e.node});
                for (std::size_t k = 0; k < strides.size(); ++k)
                    ASSERT_EQ(cache.read(e.owner, e.node, k), expected[k]) << "step " << step << " node " << e.node;
                for (const ColumnPiece& piece : entry->pieces)
                    for (const BufferRange& range : piece.columns) {
                        ASSERT_EQ(range.offset % 256, 0u);
                        ASSERT_LE(range.offset + range.bytes, options.block_bytes);
                    }
            }
    }
    expect_same_counts(cache.statistics(), model.counts);
    EXPECT_GT(refused_by_store + failed_flushes + failed_shrinks, 20u);
    EXPECT_GT(cache.statistics().evictions, 100u);
    EXPECT_GT(cache.statistics().failed_write_backs, 20u);

    // The disk works again: no marked column of any owner is lost.
    if (!broken.empty()) broken.clear();
    cache.flush();
    std::uint64_t bytes = 0;
    for (const auto& [owner, nodes] : marked)
        for (const auto& [node, columns] : nodes)
            for (const auto& [k, column] : columns) EXPECT_EQ(stores.at(owner)->stored[node][k], column);
    for (const auto& [owner, store] : stores) bytes += store->bytes;
    EXPECT_EQ(cache.statistics().written_back_bytes, bytes);
    EXPECT_EQ(cache.statistics().write_back_times.count(), cache.statistics().written_back_chunks);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    cache.release();
    EXPECT_EQ(cache.statistics().resident_chunks, 0u);
}

TEST(L1Columns, FailedWriteBacksStayAndTheErrorReachesTheCaller)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Options options;
    options.block_bytes = options.capacity_bytes = 1u << 20;
    L1Cache cache(options);
    const auto store = std::make_shared<FaultyStore>();
    std::set<NodeId> broken{7};
    store->broken = &broken;
    const auto owner = cache.add_owner(store);
    const Columns columns = random_columns(30000, 1);  // 690 kB: room for one
    ASSERT_TRUE(cache.upload_columns(owner, 7, 30000, {}, sources_of(columns), true));
    const Columns other = random_columns(30000, 2);
    change_in_video_memory(*cache.find_columns(owner, 7), 1, other[1]);
    cache.mark_written(owner, 7, 1);
    try {
        cache.mark_written(owner, 7, strides.size());
        ADD_FAILURE() << "one column beyond the last was marked";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("there are " + std::to_string(strides.size()) + " columns"),
                  std::string::npos)
            << error.what();
    }
    try {
        cache.read(owner, 7, strides.size());
        ADD_FAILURE() << "one column beyond the last was read";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("column 3 of node 7"), std::string::npos) << error.what();
    }
    EXPECT_THROW(cache.mark_written(owner, 8, 0), Error);
    EXPECT_THROW(cache.mark_written(cache.add_owner(), 7, 0), Error);

    const auto code_of = [](const std::exception_ptr& error) {
        try {
            std::rethrow_exception(error);
        } catch (const Error& e) {
            return e.code();
        }
    };
    cache.begin_frame(owner);
    EXPECT_FALSE(cache.upload_columns(owner, 8, 30000, {}, sources_of(columns), true));
    ASSERT_TRUE(cache.write_back_error());
    EXPECT_EQ(code_of(cache.write_back_error()), ErrorCode::no_space);
    EXPECT_THROW(cache.flush(), Error);
    EXPECT_THROW(cache.release(), Error);
    EXPECT_TRUE(store->stored.empty());
    cache.remove_owner(owner);  // as when a computation ended early
    EXPECT_THROW(cache.release(), Error);
    EXPECT_EQ(cache.read(owner, 7, 1), other[1]);
    cache.flush(owner + 1);  // another owner has nothing to flush

    broken.clear();
    cache.release();
    EXPECT_EQ(store->stored.at(7).size(), 1u);
    EXPECT_EQ(store->stored.at(7).at(1), other[1]);
    EXPECT_EQ(cache.statistics().allocated_bytes, 0u);
}

TEST(L1Columns, DiscardedChangesAreNotWrittenBack)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Cache cache;
    const auto store = std::make_shared<FaultyStore>();
    const std::set<NodeId> broken{1, 2};
    store->broken = &broken;
    const Columns columns = random_columns(10, 1);
    for (const bool of_one : {true, false}) {
        const auto owner = cache.add_owner(store);
        for (const NodeId node : {1u, 2u}) {
            ASSERT_TRUE(cache.upload_columns(owner, node, 10, {}, sources_of(columns), false));
            cache.mark_written(owner, node, 2);
        }
        cache.remove_owner(owner);
        EXPECT_EQ(cache.statistics().resident_chunks, 2u);
        EXPECT_THROW(cache.release(), Error);
        of_one ? cache.discard(owner) : cache.discard();
        EXPECT_EQ(cache.statistics().resident_chunks, 0u);
        cache.release();
    }
    EXPECT_EQ(store.use_count(), 1);
    EXPECT_TRUE(store->stored.empty());
}

TEST(L1Columns, PinnedEntriesKeepTheirPlace)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Options options;
    options.block_bytes = options.capacity_bytes = 1u << 20;
    L1Cache cache(options);
    const auto owner = cache.add_owner();
    const Columns columns = random_columns(30000, 1);
    ASSERT_TRUE(cache.upload_columns(owner, 1, 30000, {}, sources_of(columns), false));
    cache.pin(owner, 1);
    for (int frame = 0; frame < 40; ++frame) cache.begin_frame(owner);
    EXPECT_FALSE(cache.upload_columns(owner, 2, 30000, {}, sources_of(columns), false));
    EXPECT_FALSE(cache.upload_columns(owner, 1, 5, {}, sources_of(columns), false));
    EXPECT_THROW(cache.release(), Error);
    cache.remove_owner(owner);
    EXPECT_EQ(cache.read(owner, 1, 2), columns[2]);
    cache.unpin(owner, 1);
    EXPECT_EQ(cache.statistics().resident_chunks, 0u);
    EXPECT_THROW(cache.upload_columns(owner, 1, 5, {}, sources_of(columns), false), Error);  // no such owner any more
    cache.release();
}
