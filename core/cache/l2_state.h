// The inside of the L2 cache: its entries and what happens to them. For l2_cache.cpp and l2_state.cpp alone.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/system/error.h"
#include "pcm/threads/brief_mutex.h"

#include <atomic>
#include <bitset>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

namespace pcm {

// A node's entry in the cache; guarded by State::mutex. It is never moved or removed while the cache lives.
//
// Invariants: charged == chunk ? chunk->bytes() : 0, and the sum of all `charged` is State::charged. An entry is listed
// in the order of use exactly when it holds a chunk, is not pinned, and is not stuck. `loading` is set while one thread
// reads, `writing` while one thread writes; both pin the entry. Other threads wait for their end on State::loaded. A
// dirty entry holds all its dirty columns.
struct L2Cache::Entry {
    NodeId node = no_node;
    std::shared_ptr<const Chunk> chunk;
    std::uint64_t charged = 0;
    std::size_t pins = 0;
    bool loading = false, writing = false, editing = false, listed = false;
    bool stuck = false;                 // its changes could not be written
    ColumnSet columns;                  // columns of `chunk`
    std::bitset<max_attributes> dirty;  // columns that differ from the store's
    std::uint64_t version = 0;          // incremented by each change
    ColumnSet once_loaded;              // since the cache was made; distinguishes compulsory from capacity misses
    bool ever_loaded = false;
    Entry *older = nullptr, *newer = nullptr;  // in the order of use
    std::optional<std::string> error;

    bool has(const ColumnSet& wanted) const { return chunk && columns.contains(wanted); }
    std::uint64_t dirty_bytes() const;
};

struct L2Cache::State {
    using Lock = std::unique_lock<BriefMutex>;

    std::shared_ptr<ChunkStore> store;
    std::vector<std::shared_ptr<const Tree>> trees;  // all that tree() has returned
    std::atomic<const Tree*> tree{nullptr};          // the last of them
    mutable BriefMutex mutex;
    std::condition_variable_any work;    // for loader threads: the list has a request, or the cache is closing
    std::condition_variable_any loaded;  // a load, a write or an edit has ended
    std::unordered_map<NodeId, Entry> entries;
    Entry *oldest = nullptr, *newest = nullptr;  // ends of the list in order of use
    struct Wanted {
        ChunkRequest request;
        Extent place;  // chunk's extent in the tree; of no bytes where it is not known
    };
    std::deque<Wanted> wanted;
    std::deque<ChunkRequest> soon;  // requests of prefetch(); served before `wanted`
    using OnLoaded = std::shared_ptr<const std::function<void(NodeId)>>;
    OnLoaded on_loaded;
    std::size_t active_loads = 0;  // loads that run on loader threads
    std::uint64_t capacity = 0;
    std::uint64_t charged = 0;
    bool closing = false;      // the loader threads are to end
    bool closed = false;       // no points are given any more
    bool room_wanted = false;  // a loader thread is to write changed chunks, so that they can be dropped
    // Every throw makes a new exception: the same object must not be shared between threads.
    struct WriteFailure {
        ErrorCode code;
        std::string what;
        [[noreturn]] void raise() const { throw Error(code, {}, what); }
    };
    std::optional<WriteFailure> write_failure;
    std::optional<NodeId> unmarked;
    L2Statistics statistics;
    std::vector<std::thread> threads;

    // To be called with the mutex held; functions that take the lock release it while they read or write.
    void check_open(NodeId node) const;
    Wanted wanted_of(const ChunkRequest& request) const;  // without the mutex
    void unlist(Entry& entry);
    void list_as_newest(Entry& entry);
    void list_as_oldest(Entry& entry);
    void pin(Entry& entry);
    void unpin(Entry& entry);
    void drop(Entry& entry);
    void make_room(Lock& lock);
    void count_miss(const Entry& entry, const ColumnSet& columns);
    Entry& entry_of(NodeId node);
    Entry& get(NodeId node, const ColumnSet& columns, Lock& lock);
    void load(Entry& entry, const ColumnSet& columns, Lock& lock);
    void load_together(const std::vector<ChunkRequest>& requests, const OnLoaded& on_each, Lock& lock);
    void begin_load(Entry& entry);
    void end_load(Entry& entry, Chunk read, const std::exception_ptr& failure, double seconds);
    Extent place_if_idle(const Wanted& wanted, const Wanted& first) const;
    std::vector<ChunkRequest> with_near_ones(const Wanted& first);
    void hand_over(Entry& entry, const OnLoaded& on_each, Lock& lock);
    void serve(Lock& lock);
    // Writes an entry that is changed and not being written. On failure it stays changed; returns the reason, which is
    // also kept in write_failure.
    std::optional<WriteFailure> write_back(Entry& entry, Lock& lock);

    void loader();  // what a loader thread runs; called without the mutex
};

}  // namespace pcm
