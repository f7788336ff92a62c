// Chunks that are changed: the cache against a naive model, one operation at a time, on a store that now and then fails
// to read, to write or to commit.

#include "pcm/cache/l2_cache.h"

#include "tests/cache/fake_store.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <list>
#include <map>
#include <random>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

// The promises of the header, in the plainest way: columns by number, 0 for positions, then the attributes in use.
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
    std::vector<std::map<int, Value>> seen;  // values that each handle had
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
    const auto steps = tries<std::uint64_t>(1000000, 100000);
    for (std::uint64_t step = 0; step < steps && !HasFatalFailure(); ++step, ++operations) {
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
    EXPECT_GE(operations, steps);
    EXPECT_GT(commits, steps / 1000);
    EXPECT_GT(refused, steps / 10000);
    EXPECT_GT(model.failed_writes, 1000u);
    EXPECT_GT(model.failed_loads, 1000u);
}

}  // namespace
