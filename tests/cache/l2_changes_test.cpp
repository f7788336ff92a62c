// Chunks that are changed: the cache against a naive model, one operation at a time, and many threads whose changes
// must all arrive; on a store that now and then fails to read, to write or to commit.

#include "pcm/cache/l2_cache.h"

#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/support.h"
#include "pcm/build/builder.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <list>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

using Value = std::uint16_t;
constexpr std::size_t columns_used =
    3;  // u16 attributes of one component, each with one value in all points of a chunk

// Keeps chunks in memory: positions of a real tree, and a value a column.
class FakeStore final : public ChunkStore {
public:
    explicit FakeStore(std::shared_ptr<const Tree> tree) : tree_(std::move(tree))
    {
        for (NodeId id = 0; id < tree_->nodes().size(); ++id)
            chunks_.push_back(tree_->read_chunk(id, ColumnSet::all(tree_->info().schema)));
    }
    std::shared_ptr<const Tree> tree() const override { return tree_; }
    Chunk read(NodeId node, const ColumnSet& columns) const override
    {
        if (fail_reads) throw Error(ErrorCode::truncated, "store", "the file ends early");
        const std::lock_guard lock(mutex_);
        ++reads;
        Chunk chunk = chunks_[node];
        if (!columns.positions) chunk.positions.reset();
        for (std::size_t k = 0; k < chunk.attributes.size(); ++k)
            if (!columns.attributes.test(k)) chunk.attributes[k].reset();
        return chunk;
    }
    ChunkPart read_part(NodeId, const ColumnSet&,
                        const std::function<bool(const Box3i&, std::uint16_t)>&) const override
    {
        return {};
    }
    bool writable() const override { return true; }
    void write(NodeId node, const Chunk& chunk, const ColumnSet& changed) override
    {
        if (fail_writes) throw Error(ErrorCode::no_space, "store", "the disk is full");
        const std::lock_guard lock(mutex_);
        EXPECT_TRUE(chunk.columns().contains(ColumnSet::all(tree_->info().schema)));
        EXPECT_TRUE(changed.attributes.any());
        // What is not told to have changed has not.
        for (std::size_t k = 0; k < chunk.attributes.size(); ++k)
            if (!changed.attributes.test(k)) {
                EXPECT_EQ(std::memcmp(chunk.attributes[k]->data(), chunks_[node].attributes[k]->data(),
                                      chunk.attributes[k]->bytes()),
                          0);
            }
        chunks_[node] = chunk;
        ++writes;
    }
    void commit() override
    {
        if (fail_commits) throw Error(ErrorCode::io, "store", "the disk does not answer");
        const std::lock_guard lock(mutex_);
        committed_ = chunks_;
    }
    Value committed(NodeId node, std::size_t column) const
    {
        return committed_[node].attributes[column]->as<Value>()[0];
    }

    std::atomic<bool> fail_reads{false}, fail_writes{false}, fail_commits{false};
    mutable std::atomic<std::uint64_t> reads{0}, writes{0};

private:
    const std::shared_ptr<const Tree> tree_;
    mutable std::mutex mutex_;
    std::vector<Chunk> chunks_, committed_;
};

class L2Changes : public testing::Test {
protected:
    void SetUp() override
    {
        auto points = records(Shape::surface, 30000, 3);
        for (LasRecord& p : points) p.intensity = p.source = 0;
        write_las(folder_ / "in.las", points, {});
        BuildOptions options;
        options.chunk_points = 1000;
        options.threads = 2;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
        auto tree = Tree::open(folder_ / "out.pct");
        ASSERT_GT(tree->nodes().size(), 30u);
        slots_ = {*tree->info().schema.find("intensity"), *tree->info().schema.find("point_source_id")};
        store_ = std::make_shared<FakeStore>(tree);
    }
    ColumnSet columns(bool positions, unsigned which) const
    {
        ColumnSet columns;
        columns.positions = positions;
        for (std::size_t c = 0; c < slots_.size(); ++c)
            if (which >> c & 1) columns.attributes.set(slots_[c]);
        return columns;
    }

    TemporaryFolder folder_;
    std::vector<std::size_t> slots_;
    std::shared_ptr<FakeStore> store_;
};

// What the header says, in the plainest way: columns by number, 0 for positions, then the attributes in use.
struct Model {
    struct Entry {
        std::set<int> columns, ever, dirty;
        std::map<int, Value> values;
        std::size_t pins = 0;
        bool known = false, stuck = false;
    };
    const Tree& tree;
    const FakeStore& store;
    std::map<NodeId, Entry> entries;
    std::list<NodeId> order;  // least recently used first
    std::map<std::pair<NodeId, int>, Value> stored;
    std::uint64_t capacity = 0, hits = 0, compulsory = 0, capacity_misses = 0, forced = 0, evictions = 0,
                  failed_loads = 0, failed_writes = 0, written = 0;
    bool failure = false;

    std::uint64_t bytes_of(NodeId node, const std::set<int>& columns) const
    {
        std::uint64_t bytes = 0;
        for (const int c : columns) bytes += (c == 0 ? 12 : sizeof(Value)) * std::uint64_t(tree.node(node).points);
        return bytes;
    }
    std::uint64_t charged() const
    {
        std::uint64_t sum = 0;
        for (const auto& [node, entry] : entries) sum += bytes_of(node, entry.columns);
        return sum;
    }
    std::uint64_t dirty() const
    {
        std::uint64_t sum = 0;
        for (const auto& [node, entry] : entries) sum += bytes_of(node, entry.dirty);
        return sum;
    }
    bool listable(const Entry& entry) const { return !entry.columns.empty() && entry.pins == 0 && !entry.stuck; }
    void touch(NodeId node)
    {
        order.remove(node);
        if (listable(entries[node])) order.push_back(node);
    }
    // Returns whether it was written.
    bool write_back(NodeId node)
    {
        Entry& entry = entries[node];
        order.remove(node);
        // The attributes that are not in use are always to be read.
        const bool fails = store.fail_reads || store.fail_writes;
        if (fails) {
            ++failed_writes;
            failure = entry.stuck = true;
            return false;
        }
        ++written;
        for (const int c : entry.dirty) stored[{node, c}] = entry.values[c];
        entry.dirty.clear();
        entry.stuck = false;
        if (listable(entry)) order.push_front(node);
        return true;
    }
    void make_room()
    {
        while (charged() > capacity && !order.empty()) {
            const NodeId node = order.front();
            if (entries[node].dirty.empty())
                drop(node);
            else
                write_back(node);
        }
    }
    void drop(NodeId node)
    {
        order.remove(node);
        entries[node].columns.clear();
        entries[node].values.clear();
        ++evictions;
    }
    // False: the load failed.
    bool get(NodeId node, const std::set<int>& columns)
    {
        Entry& entry = entries[node];
        const auto has = [](const std::set<int>& all, const std::set<int>& some) {
            return std::includes(all.begin(), all.end(), some.begin(), some.end());
        };
        if (!entry.columns.empty() && has(entry.columns, columns)) {
            ++hits;
        } else {
            ++(entry.known && has(entry.ever, columns) ? capacity_misses : compulsory);
            ++forced;
            if (store.fail_reads) {
                ++failed_loads;
                touch(node);
                return false;
            }
            for (const int c : columns)
                if (entry.columns.insert(c).second && c > 0) entry.values[c] = stored[{node, c}];
            entry.ever.insert(entry.columns.begin(), entry.columns.end());
            entry.known = true;
        }
        ++entry.pins;
        touch(node);
        make_room();
        return true;
    }
    void release(NodeId node)
    {
        if (--entries[node].pins > 0) return;
        touch(node);
        make_room();
    }
};

TEST_F(L2Changes, AMillionOperationsAgainstANaiveModel)
{
    std::mt19937_64 random(17);
    const auto below = [&](std::uint64_t n) { return random() % n; };
    L2Options options;
    options.capacity_bytes = 100000;
    L2Cache cache(store_, options);
    Model model{*store_->tree(), *store_, {}, {}, {}, 100000};
    const std::vector<NodeId> nodes = [&] {
        std::vector<NodeId> some;
        for (NodeId id = 0; id < store_->tree()->nodes().size() && some.size() < 12; ++id)
            if (store_->tree()->node(id).points) some.push_back(id);
        return some;
    }();
    std::vector<std::pair<NodeId, L2Cache::Handle>> held;
    std::vector<std::map<int, Value>> seen;  // by each of them
    const auto check_values = [&](const Chunk& chunk, const std::map<int, Value>& values) {
        for (const auto& [c, value] : values) {
            if (c == 0) continue;
            const Column& column = *chunk.attributes[slots_[static_cast<std::size_t>(c - 1)]];
            ASSERT_EQ(column.as<Value>()[0], value);
            ASSERT_EQ(column.as<Value>()[chunk.points - 1], value);
        }
    };
    const auto pick = [&](std::set<int>& names) {
        const auto which = static_cast<unsigned>(below(4));
        const bool positions = which == 0 || below(2);
        if (positions) names.insert(0);
        for (int c = 0; c < 2; ++c)
            if (which >> c & 1) names.insert(c + 1);
        return columns(positions, which);
    };
    Value next = 1;
    bool unmarked = false;
    std::uint64_t operations = 0, commits = 0, refused = 0;
    for (std::uint64_t step = 0; step < 1000000 && !HasFatalFailure(); ++step, ++operations) {
        const NodeId node = nodes[below(nodes.size())];
        switch (below(40)) {
            case 0:
                store_->fail_reads = below(6) == 0;
                break;
            case 1:
                store_->fail_writes = below(3) == 0;
                break;
            case 2:
                model.capacity = 1000 * (1 + below(150));
                model.make_room();
                cache.set_capacity(model.capacity);
                break;
            case 3: {
                if (below(20)) break;
                for (auto id = model.order.begin(); id != model.order.end();) {
                    const NodeId clean = *id++;
                    if (model.entries[clean].dirty.empty()) model.drop(clean);
                }
                cache.clear();
                break;
            }
            case 4: {  // flush
                if (below(4)) break;
                store_->fail_commits = below(4) == 0;
                bool fine = !unmarked;
                const bool was_unmarked = unmarked;
                unmarked = false;
                if (fine) {
                    for (auto& [id, entry] : model.entries)
                        if (fine && !entry.dirty.empty()) fine = model.write_back(id);
                    if (fine) model.failure = false;
                    fine = fine && !store_->fail_commits;
                }
                if (fine) {
                    cache.flush();
                    ++commits;
                    for (const auto& [place, value] : model.stored)
                        ASSERT_EQ(store_->committed(place.first, slots_[static_cast<std::size_t>(place.second - 1)]),
                                  value);
                } else {
                    try {
                        cache.flush();
                        FAIL() << "it should have failed";
                    } catch (const Error& error) {
                        ASSERT_EQ(error.code() == ErrorCode::invalid_argument, was_unmarked);
                    }
                }
                break;
            }
            case 5:
            case 6:
            case 7:
            case 8:
            case 9:
            case 10:
            case 11:
            case 12: {  // change
                std::set<int> names;
                const ColumnSet asked = pick(names);
                if (model.failure && model.charged() > model.capacity) {
                    ASSERT_THROW(cache.edit(node, asked), Error);
                    ++refused;
                    break;
                }
                if (!model.get(node, names)) {
                    ASSERT_THROW(cache.edit(node, asked), Error);
                    break;
                }
                L2Cache::Edit edit = cache.edit(node, asked);
                std::map<int, Value> pending;
                const auto mark = [&] {
                    edit.mark_written();
                    for (const auto& [c, value] : pending) {
                        model.entries[node].values[c] = value;
                        model.entries[node].dirty.insert(c);
                    }
                    if (!pending.empty()) model.make_room();
                    pending.clear();
                };
                for (int c = 1; c <= 2; ++c) {
                    if (!names.count(c) || below(3) == 0) continue;
                    Column& column = edit.column(slots_[static_cast<std::size_t>(c - 1)]);
                    ASSERT_EQ(column.as<Value>()[column.size() - 1], model.entries[node].values[c]);
                    std::fill_n(column.as<Value>(), column.size(), next);
                    pending[c] = next++;
                    if (below(3) == 0) mark();
                }
                switch (below(20)) {
                    case 0:
                        break;
                    case 1:
                        edit.discard();
                        pending.clear();
                        break;
                    default:
                        mark();
                }
                const bool changed = !pending.empty();
                ASSERT_EQ(edit.changed(), changed);
                unmarked = unmarked || changed;
                {
                    const L2Cache::Edit gone = std::move(edit);
                }
                model.release(node);
                break;
            }
            case 13:
            case 14:
            case 15:
            case 16:
            case 17:
            case 18:
            case 19:
            case 20:
            case 21:
            case 22: {  // hold
                if (held.size() > 5) break;
                std::set<int> names;
                const ColumnSet asked = pick(names);
                if (!model.get(node, names)) {
                    ASSERT_THROW(cache.get(node, asked), Error);
                    break;
                }
                held.emplace_back(node, cache.get(node, asked));
                seen.push_back(model.entries[node].values);
                break;
            }
            case 23:
            case 24:
            case 25: {  // find
                std::set<int> names;
                const ColumnSet asked = pick(names);
                Model::Entry& entry = model.entries[node];
                const bool there = !entry.columns.empty() && std::includes(entry.columns.begin(), entry.columns.end(),
                                                                           names.begin(), names.end());
                {
                    const L2Cache::Handle handle = cache.find(node, asked);
                    ASSERT_EQ(static_cast<bool>(handle), there);
                    if (there) check_values(*handle, entry.values);
                    if (there) {
                        ++model.hits;
                        ++entry.pins;
                        model.touch(node);
                    }
                }
                if (there) model.release(node);
                break;
            }
            default: {  // let go
                if (held.empty()) break;
                const std::size_t which = below(held.size());
                check_values(*held[which].second, seen[which]);  // as it was when it was asked for
                const NodeId id = held[which].first;
                held[which] = std::move(held.back());
                held.pop_back();
                seen[which] = std::move(seen.back());
                seen.pop_back();
                model.release(id);
            }
        }
        cache.wait_idle();
        const L2Statistics found = cache.statistics();
        ASSERT_EQ(found.hits, model.hits) << step;
        ASSERT_EQ(found.compulsory_misses, model.compulsory) << step;
        ASSERT_EQ(found.capacity_misses, model.capacity_misses) << step;
        ASSERT_EQ(found.forced_misses, model.forced) << step;
        ASSERT_EQ(found.failed_loads, model.failed_loads) << step;
        ASSERT_EQ(found.failed_writes, model.failed_writes) << step;
        ASSERT_EQ(found.written_chunks, model.written) << step;
        ASSERT_EQ(found.evictions, model.evictions) << step;
        ASSERT_EQ(found.resident_bytes, model.charged()) << step;
        ASSERT_EQ(found.dirty_bytes, model.dirty()) << step;
    }
    EXPECT_GE(operations, 1000000u);
    EXPECT_GT(commits, 1000u);
    EXPECT_GT(refused, 100u);
    EXPECT_GT(model.failed_writes, 1000u);
    EXPECT_GT(model.failed_loads, 1000u);
}

// Every thread adds to counters; whatever fails on the way, in the end they are all there.
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

TEST_F(L2Changes, MisuseIsToldClearly)
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

}  // namespace
