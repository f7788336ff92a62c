#include "pcm/cache/l2_state.h"

#include "pcm/system/error.h"
#include "pcm/system/seconds.h"
#include "pcm/tree/read_together.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace pcm {
namespace {

// The columns of `chunk`, and the columns of `more` that it lacks.
std::shared_ptr<const Chunk> join(std::shared_ptr<const Chunk> chunk, Chunk more)
{
    if (!chunk) return std::make_shared<const Chunk>(std::move(more));
    auto joined = std::make_shared<Chunk>(*chunk);
    if (!joined->positions) joined->positions = std::move(more.positions);
    if (!joined->sizes) joined->sizes = std::move(more.sizes);
    if (joined->attributes.size() < more.attributes.size()) joined->attributes.resize(more.attributes.size());
    for (std::size_t k = 0; k < more.attributes.size(); ++k)
        if (!joined->attributes[k]) joined->attributes[k] = std::move(more.attributes[k]);
    return joined;
}

ColumnSet missing(const std::shared_ptr<const Chunk>& chunk, const ColumnSet& columns)
{
    if (!chunk) return columns;
    const ColumnSet present = chunk->columns();
    ColumnSet missing = columns;
    missing.positions = columns.positions && !present.positions;
    missing.sizes = columns.sizes && !present.sizes;
    missing.attributes &= ~present.attributes;
    return missing;
}

std::string message_of(const std::exception_ptr& failure)
{
    try {
        std::rethrow_exception(failure);
    } catch (const std::exception& error) {
        return error.what();
    }
}

}  // namespace

std::uint64_t L2Cache::Entry::dirty_bytes() const
{
    std::uint64_t bytes = 0;
    for (std::size_t k = 0; k < chunk->attributes.size(); ++k)
        if (dirty.test(k)) bytes += chunk->attributes[k]->bytes();
    return bytes;
}

void L2Cache::State::check_open(NodeId node) const
{
    if (closed)
        throw Error(ErrorCode::invalid_argument, trees.back()->folder(), "this point cloud was closed",
                    "open it again");
    if (node >= trees.back()->nodes().size())
        throw Error(ErrorCode::invalid_argument, trees.back()->folder(),
                    "no node " + std::to_string(node) + " in this tree");
}

L2Cache::Entry& L2Cache::State::entry_of(NodeId node)
{
    const auto [place, made] = entries.try_emplace(node);
    if (made) place->second.node = node;  // only once: it is read without the lock
    return place->second;
}

void L2Cache::State::unlist(Entry& entry)
{
    if (!entry.listed) return;
    (entry.older ? entry.older->newer : oldest) = entry.newer;
    (entry.newer ? entry.newer->older : newest) = entry.older;
    entry.older = entry.newer = nullptr;
    entry.listed = false;
}

void L2Cache::State::list_as_newest(Entry& entry)
{
    unlist(entry);
    if (!entry.chunk || entry.pins > 0 || entry.stuck) return;
    entry.older = newest;
    (newest ? newest->newer : oldest) = &entry;
    newest = &entry;
    entry.listed = true;
}

void L2Cache::State::list_as_oldest(Entry& entry)
{
    unlist(entry);
    if (!entry.chunk || entry.pins > 0 || entry.stuck) return;
    entry.newer = oldest;
    (oldest ? oldest->older : newest) = &entry;
    oldest = &entry;
    entry.listed = true;
}

void L2Cache::State::pin(Entry& entry)
{
    ++entry.pins;
    unlist(entry);
}

void L2Cache::State::unpin(Entry& entry)
{
    if (--entry.pins > 0) return;
    list_as_newest(entry);
    while (charged > capacity && oldest && oldest->dirty.none()) drop(*oldest);
    if (charged > capacity && oldest && !closing) {
        // A loader thread writes: releasing a handle must be quick and cannot fail.
        room_wanted = true;
        work.notify_one();
    }
}

void L2Cache::State::drop(Entry& entry)
{
    unlist(entry);
    if (entry.dirty.any()) {
        statistics.dirty_bytes -= entry.dirty_bytes();
        entry.dirty.reset();
    }
    charged -= entry.charged;
    entry.charged = 0;
    entry.chunk.reset();
    entry.columns = ColumnSet();
    entry.columns.positions = false;
    --statistics.resident_chunks;
    ++statistics.evictions;
}

void L2Cache::State::make_room(Lock& lock)
{
    while (charged > capacity && oldest) {
        if (oldest->dirty.none())
            drop(*oldest);
        else
            write_back(*oldest, lock);
    }
}

auto L2Cache::State::write_back(Entry& entry, Lock& lock) -> std::optional<WriteFailure>
{
    entry.writing = true;
    pin(entry);
    const std::shared_ptr<const Chunk> chunk = entry.chunk;
    ColumnSet changed;
    changed.positions = false;
    changed.attributes = entry.dirty;
    const std::uint64_t version = entry.version, bytes = entry.dirty_bytes();
    lock.unlock();
    const auto start = std::chrono::steady_clock::now();
    std::optional<WriteFailure> failure;
    try {
        const ColumnSet others = missing(chunk, ColumnSet::whole(store->tree()->info().schema));
        const bool whole = !others.positions && !others.sizes && others.attributes.none();
        store->write(entry.node, whole ? *chunk : *join(chunk, store->read(entry.node, others)), changed);
    } catch (const Error& error) {
        failure = WriteFailure{error.code(), error.what()};
    } catch (const std::exception& error) {
        failure = WriteFailure{ErrorCode::io, error.what()};
    }
    const double seconds = seconds_since(start);
    lock.lock();
    entry.writing = false;
    statistics.write_seconds += seconds;
    if (failure) {
        ++statistics.failed_writes;
        write_failure = failure;
        entry.stuck = true;
    } else {
        ++statistics.written_chunks;
        statistics.written_bytes += bytes;
        entry.stuck = false;
        if (entry.version == version) {
            entry.dirty.reset();
            statistics.dirty_bytes -= bytes;
        }
    }
    if (--entry.pins == 0) entry.dirty.any() ? list_as_newest(entry) : list_as_oldest(entry);
    loaded.notify_all();
    return failure;
}

void L2Cache::State::count_miss(const Entry& entry, const ColumnSet& columns)
{
    if (entry.ever_loaded && entry.once_loaded.contains(columns))
        ++statistics.capacity_misses;
    else
        ++statistics.compulsory_misses;
}

L2Cache::Entry& L2Cache::State::get(NodeId node, const ColumnSet& columns, Lock& lock)
{
    Entry& entry = entry_of(node);
    for (bool missed = false;;) {
        if (entry.has(columns)) {
            if (!missed) ++statistics.hits;
            return entry;
        }
        if (!missed) {
            count_miss(entry, columns);
            ++statistics.forced_misses;
            missed = true;
        }
        if (entry.loading) {
            loaded.wait(lock);
            continue;
        }
        load(entry, columns, lock);
    }
}

// From here to end_load() the entry belongs to one thread, which reads.
void L2Cache::State::begin_load(Entry& entry)
{
    entry.loading = true;
    pin(entry);  // its columns, changed ones included, must stay until the others are read
}

void L2Cache::State::end_load(Entry& entry, Chunk read, const std::exception_ptr& failure, double seconds)
{
    entry.loading = false;
    --entry.pins;
    statistics.load_seconds += seconds;
    if (failure) {
        ++statistics.failed_loads;
        entry.error = message_of(failure);
    } else {
        statistics.load_times.add(seconds);
        entry.error.reset();
        if (!entry.chunk) ++statistics.resident_chunks;
        entry.chunk = join(std::move(entry.chunk), std::move(read));
        const std::uint64_t bytes = entry.chunk->bytes();
        statistics.loaded_bytes += bytes - entry.charged;
        charged += bytes - entry.charged;
        entry.charged = bytes;
        entry.columns = entry.chunk->columns();
        if (entry.ever_loaded)
            entry.once_loaded |= entry.columns;
        else
            entry.once_loaded = entry.columns;
        entry.ever_loaded = true;
    }
    list_as_newest(entry);
    loaded.notify_all();
}

// Reads the columns that the entry lacks.
void L2Cache::State::load(Entry& entry, const ColumnSet& columns, Lock& lock)
{
    begin_load(entry);
    const ColumnSet lacking = missing(entry.chunk, columns);
    lock.unlock();
    const auto start = std::chrono::steady_clock::now();
    Chunk read;
    std::exception_ptr failure;
    try {
        read = store->read(entry.node, lacking);
    } catch (const std::exception&) {
        failure = std::current_exception();
    }
    const double seconds = seconds_since(start);
    lock.lock();
    end_load(entry, std::move(read), failure, seconds);
    if (failure) std::rethrow_exception(failure);
}

// The same for several entries that nobody loads; then they are handed over, in this order. Errors are counted, and
// kept in the entries for error_of().
void L2Cache::State::load_together(const std::vector<ChunkRequest>& requests, const OnLoaded& on_each, Lock& lock)
{
    std::vector<ChunkRequest> lacking;
    std::vector<Entry*> of_batch;
    for (const ChunkRequest& request : requests) {
        Entry& entry = entry_of(request.node);
        count_miss(entry, request.columns);
        begin_load(entry);
        pin(entry);  // until it is handed over
        lacking.push_back({request.node, missing(entry.chunk, request.columns)});
        of_batch.push_back(&entry);
    }
    lock.unlock();
    std::vector<Entry*> left = of_batch;
    auto start = std::chrono::steady_clock::now();
    std::exception_ptr failure;
    try {
        store->read_many(lacking, [&](std::size_t i, Chunk chunk, const std::exception_ptr& why) {
            const double seconds = seconds_since(start);
            {
                const std::lock_guard guard(mutex);
                end_load(*std::exchange(left[i], nullptr), std::move(chunk), why, seconds);
            }
            start = std::chrono::steady_clock::now();
        });
    } catch (const std::exception&) {
        failure = std::current_exception();
    }
    lock.lock();
    for (Entry* const entry : left)
        if (entry) end_load(*entry, {}, failure, 0);
    for (Entry* const entry : of_batch) {
        hand_over(*entry, on_each, lock);
        unpin(*entry);
    }
}

auto L2Cache::State::wanted_of(const ChunkRequest& request) const -> Wanted
{
    try {
        return {request, tree.load()->nodes().at(request.node).extent};
    } catch (const std::exception&) {
        return {request, {}};  // its load has the same error
    }
}

// Where its chunk is read from; nowhere for one that is loaded, or being loaded, or the first one again.
Extent L2Cache::State::place_if_idle(const Wanted& one, const Wanted& first) const
{
    if (one.request.node == first.request.node) return {};
    const auto found = entries.find(one.request.node);
    const bool idle = found == entries.end() || (!found->second.loading && !found->second.has(one.request.columns));
    return idle ? one.place : Extent();
}

// The request, and those after it in the list that are read together with it; they leave the list.
std::vector<ChunkRequest> L2Cache::State::with_near_ones(const Wanted& first)
{
    constexpr std::size_t far = 256;  // in the list; sorting more of it would cost more than it saves
    std::vector<Extent> places = {first.place};
    for (std::size_t i = 0; i < std::min(far, wanted.size()); ++i) places.push_back(place_if_idle(wanted[i], first));
    std::vector<std::size_t> together = read_together(places);
    std::sort(together.begin(), together.end());  // the order of the list
    std::vector<ChunkRequest> requests = {first.request};
    for (std::size_t k = 1; k < together.size(); ++k) requests.push_back(wanted[together[k] - 1].request);
    for (; together.size() > 1; together.pop_back())
        wanted.erase(wanted.begin() + static_cast<std::ptrdiff_t>(together.back() - 1));
    return requests;
}

void L2Cache::State::hand_over(Entry& entry, const OnLoaded& on_each, Lock& lock)
{
    pin(entry);  // a chunk larger than the capacity, too, is there for on_loaded
    make_room(lock);
    if (on_each && *on_each) {
        lock.unlock();
        (*on_each)(entry.node);
        lock.lock();
    }
    unpin(entry);
}

// Serves the first request, and those that are read together with it.
void L2Cache::State::serve(Lock& lock)
{
    const bool is_prefetch = !soon.empty();
    const Wanted first = is_prefetch ? Wanted{soon.front(), {}} : wanted.front();
    is_prefetch ? soon.pop_front() : wanted.pop_front();
    const OnLoaded on_each = is_prefetch ? nullptr : on_loaded;
    ++active_loads;
    Entry& entry = entry_of(first.request.node);
    // Another client may be loading the chunk: wait, then see which columns are missing.
    loaded.wait(lock, [&] { return closing || !entry.loading; });
    if (closing) return;
    if (entry.has(first.request.columns))
        hand_over(entry, on_each, lock);
    else if (is_prefetch || on_each != on_loaded)  // those near it are of another list, or of none
        load_together({first.request}, on_each, lock);
    else
        load_together(with_near_ones(first), on_each, lock);
    --active_loads;
    loaded.notify_all();
}

void L2Cache::State::loader()
{
    std::unique_lock lock(mutex);
    for (;;) {
        work.wait(lock, [&] { return closing || room_wanted || !wanted.empty() || !soon.empty(); });
        if (closing) return;
        if (!room_wanted) {
            serve(lock);
            continue;
        }
        room_wanted = false;
        ++active_loads;
        make_room(lock);
        --active_loads;
        loaded.notify_all();
    }
}

}  // namespace pcm
