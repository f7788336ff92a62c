#include "cache/l2_cache.h"

#include "cloud/error.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <thread>
#include <unordered_map>

namespace pcm {

namespace {

// Runs a function when the last copy of a handle dies.
struct Pin {
    std::function<void()> release;
    ~Pin() { release(); }
};

}  // namespace

// One node's place in the cache. Lives in State::entries; all members are guarded by State::mutex.
//
// Invariants: charged == chunk ? chunk->bytes() : 0, and the sum of all `charged` is State::charged. An entry is in the LRU list exactly
// when it holds a chunk and nobody pins it. `loading` is set while one thread reads; others wait for it on State::loaded.
struct L2Cache::Entry {
    std::shared_ptr<const Chunk> chunk;
    std::uint64_t charged = 0;
    std::size_t pins = 0;
    bool loading = false;
    ColumnSet columns;          // of `chunk`
    ColumnSet once_loaded;      // ever since the cache was made; tells compulsory from capacity misses
    bool ever_loaded = false;
    std::optional<std::list<NodeId>::iterator> place;  // in the LRU list
    std::optional<std::string> error;
};

struct L2Cache::State {
    std::shared_ptr<const Tree> tree;
    mutable std::mutex mutex;
    std::condition_variable work;    // for loader threads: there is something in the list, or the end has come
    std::condition_variable loaded;  // for get() and wait_idle(): a load has finished
    std::unordered_map<NodeId, Entry> entries;
    std::list<NodeId> lru;  // least recently used first
    std::deque<ChunkRequest> wanted;
    std::deque<ChunkRequest> soon;  // of prefetch(); goes before `wanted`
    std::shared_ptr<const std::function<void(NodeId)>> on_loaded;
    std::size_t active_loads = 0;  // of loader threads
    std::uint64_t capacity = 0;
    std::uint64_t charged = 0;
    bool closing = false;
    L2Statistics statistics;
    std::vector<std::thread> threads;

    // Below: with the mutex held, unless said otherwise.
    void unlist(Entry& entry)
    {
        if (entry.place) lru.erase(*entry.place);
        entry.place.reset();
    }
    void list_as_newest(NodeId node, Entry& entry)
    {
        unlist(entry);
        if (entry.chunk && entry.pins == 0) entry.place = lru.insert(lru.end(), node);
    }
    void drop(Entry& entry)
    {
        unlist(entry);
        charged -= entry.charged;
        entry.charged = 0;
        entry.chunk.reset();
        entry.columns = ColumnSet();
        entry.columns.positions = false;
        --statistics.resident_chunks;
        ++statistics.evictions;
    }
    void shrink()
    {
        while (charged > capacity && !lru.empty()) drop(entries[lru.front()]);
    }
    void count_miss(const Entry& entry, const ColumnSet& columns)
    {
        if (entry.ever_loaded && entry.once_loaded.contains(columns))
            ++statistics.capacity_misses;
        else
            ++statistics.compulsory_misses;
    }

    static std::shared_ptr<void> pin(const std::shared_ptr<State>& state, NodeId node)
    {
        auto& entry = state->entries[node];
        ++entry.pins;
        state->unlist(entry);
        auto pin = std::make_shared<Pin>();
        pin->release = [weak = std::weak_ptr<State>(state), node] {
            const auto alive = weak.lock();
            if (!alive) return;
            const std::lock_guard lock(alive->mutex);
            auto& released = alive->entries[node];
            if (--released.pins == 0) {
                alive->list_as_newest(node, released);
                alive->shrink();
            }
        };
        return pin;
    }

    // Reads the columns the entry lacks; `lock` is held before and after, not while reading. The caller has set `loading`.
    static void load(const std::shared_ptr<State>& state, NodeId node, const ColumnSet& columns,
                     std::unique_lock<std::mutex>& lock)
    {
        const std::shared_ptr<const Chunk> present = state->entries[node].chunk;
        ColumnSet missing = columns;
        if (present) {
            missing.positions = columns.positions && !present->positions;
            missing.attributes &= ~present->columns().attributes;
        }
        lock.unlock();
        const auto start = std::chrono::steady_clock::now();
        std::shared_ptr<Chunk> chunk;
        std::exception_ptr failure;
        std::string message;
        try {
            chunk = std::make_shared<Chunk>(state->tree->read_chunk(node, missing));
            if (present) {
                if (!chunk->positions) chunk->positions = present->positions;
                for (std::size_t i = 0; i < chunk->attributes.size(); ++i)
                    if (!chunk->attributes[i]) chunk->attributes[i] = present->attributes[i];
            }
        } catch (const std::exception& error) {
            failure = std::current_exception();
            message = error.what();
        }
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        lock.lock();
        auto& entry = state->entries[node];
        entry.loading = false;
        state->statistics.load_seconds += seconds;
        if (failure) {
            ++state->statistics.failed_loads;
            entry.error = message;
            state->loaded.notify_all();
            std::rethrow_exception(failure);
        }
        entry.error.reset();
        // Nobody else changes the chunk of an entry that is loading, but it may have been dropped meanwhile.
        if (!entry.chunk) ++state->statistics.resident_chunks;
        const std::uint64_t bytes = chunk->bytes();
        state->statistics.loaded_bytes += bytes - (present ? present->bytes() : 0);
        state->charged += bytes - entry.charged;
        entry.charged = bytes;
        entry.chunk = std::move(chunk);
        entry.columns = entry.chunk->columns();
        entry.once_loaded |= entry.columns;
        if (!entry.ever_loaded) entry.once_loaded = entry.columns;
        entry.ever_loaded = true;
        state->list_as_newest(node, entry);
        state->loaded.notify_all();
    }

    // A loader thread's life; called without the mutex.
    static void loader(const std::shared_ptr<State>& state)
    {
        std::unique_lock lock(state->mutex);
        for (;;) {
            state->work.wait(lock, [&] { return state->closing || !state->wanted.empty() || !state->soon.empty(); });
            if (state->closing) return;
            const bool is_prefetch = !state->soon.empty();
            std::deque<ChunkRequest>& queue = is_prefetch ? state->soon : state->wanted;
            const ChunkRequest request = queue.front();
            queue.pop_front();
            const auto on_loaded = is_prefetch ? nullptr : state->on_loaded;
            ++state->active_loads;
            auto& entry = state->entries[request.node];
            // Another client may be loading it: what comes is looked at then.
            state->loaded.wait(lock, [&] { return state->closing || !entry.loading; });
            if (state->closing) return;
            if (!entry.chunk || !entry.columns.contains(request.columns)) {
                state->count_miss(entry, request.columns);
                entry.loading = true;
                try {
                    load(state, request.node, request.columns, lock);
                    state->shrink();
                } catch (const std::exception&) {
                    // Kept in the entry for error_of(), and counted.
                }
            }
            if (on_loaded && *on_loaded) {
                lock.unlock();
                (*on_loaded)(request.node);
                lock.lock();
            }
            --state->active_loads;
            state->loaded.notify_all();
        }
    }
};

L2Cache::L2Cache(std::shared_ptr<const Tree> tree, const L2Options& options) : state_(std::make_shared<State>())
{
    state_->tree = std::move(tree);
    state_->capacity = options.capacity_bytes;
    for (unsigned t = 0; t < std::max(1u, options.threads); ++t)
        state_->threads.emplace_back([state = state_] { State::loader(state); });
}

L2Cache::~L2Cache()
{
    {
        const std::lock_guard lock(state_->mutex);
        state_->closing = true;
        state_->wanted.clear();
        state_->soon.clear();
    }
    state_->work.notify_all();
    state_->loaded.notify_all();
    for (std::thread& thread : state_->threads) thread.join();
}

L2Cache::Handle L2Cache::get(NodeId node, const ColumnSet& columns)
{
    if (node >= state_->tree->nodes().size())
        throw Error(ErrorCode::invalid_argument, {}, "no node " + std::to_string(node) + " in this tree");
    std::unique_lock lock(state_->mutex);
    bool missed = false;
    for (;;) {
        Entry& entry = state_->entries[node];
        if (entry.chunk && entry.columns.contains(columns)) {
            if (!missed) ++state_->statistics.hits;
            Handle handle;
            handle.chunk_ = entry.chunk;
            handle.pin_ = State::pin(state_, node);
            state_->shrink();
            return handle;
        }
        if (!missed) {
            state_->count_miss(entry, columns);
            ++state_->statistics.forced_misses;
            missed = true;
        }
        if (entry.loading) {
            state_->loaded.wait(lock);
            continue;
        }
        entry.loading = true;
        // Ask for what is there already too, so that a drop in between costs nothing but the reading.
        State::load(state_, node, columns, lock);
    }
}

L2Cache::Handle L2Cache::find(NodeId node, const ColumnSet& columns)
{
    const std::lock_guard lock(state_->mutex);
    const auto found = state_->entries.find(node);
    Handle handle;
    if (found == state_->entries.end() || !found->second.chunk || !found->second.columns.contains(columns)) return handle;
    ++state_->statistics.hits;
    handle.chunk_ = found->second.chunk;
    handle.pin_ = State::pin(state_, node);
    return handle;
}

void L2Cache::request(std::vector<ChunkRequest> list, std::function<void(NodeId)> on_loaded)
{
    {
        const std::lock_guard lock(state_->mutex);
        const std::size_t nodes = state_->tree->nodes().size();
        state_->wanted.clear();
        for (ChunkRequest& request : list)
            if (request.node < nodes) state_->wanted.push_back(std::move(request));
        state_->on_loaded = std::make_shared<const std::function<void(NodeId)>>(std::move(on_loaded));
    }
    state_->work.notify_all();
    state_->loaded.notify_all();
}

void L2Cache::prefetch(const ChunkRequest& request)
{
    constexpr std::size_t most = 16;  // older hints than that are of no use to anybody
    if (request.node >= state_->tree->nodes().size()) return;
    {
        const std::lock_guard lock(state_->mutex);
        if (state_->soon.size() == most) state_->soon.pop_front();
        state_->soon.push_back(request);
    }
    state_->work.notify_one();
}

std::optional<std::string> L2Cache::error_of(NodeId node) const
{
    const std::lock_guard lock(state_->mutex);
    const auto found = state_->entries.find(node);
    return found == state_->entries.end() ? std::nullopt : found->second.error;
}

void L2Cache::wait_idle()
{
    std::unique_lock lock(state_->mutex);
    state_->loaded.wait(lock, [&] { return state_->wanted.empty() && state_->soon.empty() && state_->active_loads == 0; });
}

void L2Cache::clear()
{
    const std::lock_guard lock(state_->mutex);
    while (!state_->lru.empty()) state_->drop(state_->entries[state_->lru.front()]);
}

void L2Cache::set_capacity(std::uint64_t bytes)
{
    const std::lock_guard lock(state_->mutex);
    state_->capacity = bytes;
    state_->shrink();
}

L2Statistics L2Cache::statistics() const
{
    const std::lock_guard lock(state_->mutex);
    L2Statistics statistics = state_->statistics;
    statistics.resident_bytes = state_->charged;
    return statistics;
}

const Tree& L2Cache::tree() const { return *state_->tree; }

}  // namespace pcm
