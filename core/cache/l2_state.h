// The inside of the L2 cache: its entries and what happens to them. For l2_cache.cpp and l2_state.cpp alone.
#pragma once

#include "pcm/threads/brief_mutex.h"
#include "pcm/cache/l2_cache.h"
#include "pcm/system/error.h"

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

// One node's place in the cache; guarded by State::mutex. It stays where it is as long as the cache lives.
//
// Invariants: charged == chunk ? chunk->bytes() : 0, and the sum of all `charged` is State::charged. An entry is in the
// order of use exactly when it holds a chunk, nobody pins it, and it is not one that could not be written. `loading` is
// set while one thread reads, `writing` while one thread writes; both pin it. Others wait for them on State::loaded. An
// entry that is dirty holds all its dirty columns.
struct L2Cache::Entry {
    NodeId node = no_node;
    std::shared_ptr<const Chunk> chunk;
    std::uint64_t charged = 0;
    std::size_t pins = 0;
    bool loading = false, writing = false, editing = false, listed = false;
    bool stuck = false;                 // could not be written
    ColumnSet columns;                  // of `chunk`
    std::bitset<max_attributes> dirty;  // columns that the store has otherwise
    std::uint64_t version = 0;          // one more with each change
    ColumnSet once_loaded;              // ever since the cache was made; tells compulsory from capacity misses
    bool ever_loaded = false;
    Entry *older = nullptr, *newer = nullptr;  // in the order of use
    std::optional<std::string> error;

    bool has(const ColumnSet& wanted) const { return chunk && columns.contains(wanted); }
    std::uint64_t dirty_bytes() const;
};

struct L2Cache::State {
    using Lock = std::unique_lock<BriefMutex>;

    std::shared_ptr<ChunkStore> store;
    std::vector<std::shared_ptr<const Tree>> trees;  // all that tree() gave
    std::atomic<const Tree*> tree{nullptr};          // the last of them
    mutable BriefMutex mutex;
    std::condition_variable_any work;    // for loader threads: there is something in the list, or the end has come
    std::condition_variable_any loaded;  // a load, a write or an edit has ended
    std::unordered_map<NodeId, Entry> entries;
    Entry *oldest = nullptr, *newest = nullptr;  // of the order of use
    std::deque<ChunkRequest> wanted;
    std::deque<ChunkRequest> soon;  // of prefetch(); goes before `wanted`
    std::shared_ptr<const std::function<void(NodeId)>> on_loaded;
    std::size_t active_loads = 0;  // of loader threads
    std::uint64_t capacity = 0;
    std::uint64_t charged = 0;
    bool closing = false;      // the loader threads' end
    bool closed = false;       // to all who want points
    bool room_wanted = false;  // a loader thread is to write what is changed, so that it can be dropped
    // Each who is told of it gets an exception of his own.
    struct WriteFailure {
        ErrorCode code;
        std::string what;
        [[noreturn]] void raise() const { throw Error(code, {}, what); }
    };
    std::optional<WriteFailure> write_failure;
    std::optional<NodeId> unmarked;
    L2Statistics statistics;
    std::vector<std::thread> threads;

    // All below with the mutex held; those that take the lock let go of it while they read or write.
    void check_open(NodeId node) const;
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
    // The entry is changed and nobody writes it. What could not be written stays changed; returns why, as write_failure
    // does.
    std::optional<WriteFailure> write_back(Entry& entry, Lock& lock);

    void loader();  // a loader thread's life; without the mutex
};

}  // namespace pcm
