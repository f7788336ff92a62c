// L2: decoded chunks of one tree in RAM, between the disk and all readers and writers of points.
//
// An entry is charged the bytes of its decoded columns. When the sum exceeds the capacity, the least recently used
// entries that are not pinned are dropped. A handle pins its entry. Loads run on the cache's own threads or on the
// caller's. A chunk that several clients request at the same time is loaded once.
//
// A changed chunk is written to the store before it is dropped, by the thread that needs the room; flush() writes all
// of them. A chunk that cannot be written stays in memory beyond the capacity; flush() throws the reason, and so does
// edit() when there is no room left.
//
// Errors of a load are thrown to the caller (get, edit), or counted and kept for error_of() (request). Any number of
// threads may call all members.
#pragma once

#include "pcm/cache/chunk_store.h"
#include "pcm/cache/load_times.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct L2Options {
    std::uint64_t capacity_bytes = std::uint64_t(512) << 20;
    unsigned threads = 1;  // loader threads; where the system gives fewer, the cache works with those, at least one
};

// Counts since the cache was made. A miss is compulsory when the columns were never loaded before, and a capacity miss
// when they were loaded and dropped. It is also forced when a synchronous caller had to wait for the load.
struct L2Statistics {
    std::uint64_t hits = 0;
    std::uint64_t compulsory_misses = 0;
    std::uint64_t capacity_misses = 0;
    std::uint64_t forced_misses = 0;
    std::uint64_t evictions = 0;
    std::uint64_t failed_loads = 0;
    std::uint64_t loaded_bytes = 0;  // decoded
    double load_seconds = 0;         // summed over threads
    LoadTimes load_times;
    std::uint64_t resident_bytes = 0;
    std::uint64_t resident_chunks = 0;
    std::uint64_t dirty_bytes = 0;  // changed columns that were not written yet
    std::uint64_t written_chunks = 0;
    std::uint64_t written_bytes = 0;  // size of the changed columns, decoded
    std::uint64_t failed_writes = 0;
    double write_seconds = 0;  // summed over threads
};

class L2Cache {
    struct Entry;
    struct State;

public:
    // Pins a chunk in the cache and keeps it as it was when the handle was made. May outlive the cache.
    class Handle {
    public:
        Handle() = default;
        Handle(const Handle& other);
        Handle(Handle&& other) noexcept;
        Handle& operator=(Handle other) noexcept;
        ~Handle();
        explicit operator bool() const { return chunk_ != nullptr; }
        const Chunk& operator*() const { return *chunk_; }
        const Chunk* operator->() const { return chunk_.get(); }

    private:
        friend class L2Cache;
        std::shared_ptr<const Chunk> chunk_;
        std::shared_ptr<State> state_;
        Entry* entry_ = nullptr;
    };

    // A chunk that is being changed. For one thread.
    class Edit {
    public:
        Edit(Edit&&) noexcept;
        Edit& operator=(Edit&&) noexcept;
        // Drops changes that were not marked; the next flush() throws an error for them unless an exception is being
        // thrown now.
        ~Edit();
        const Chunk& chunk() const;  // with the changes that were marked so far
        // A private copy of one of the edit's columns, to be changed. Its size must stay.
        Column& column(std::size_t attribute);
        // Hands the changed columns to the cache. Existing handles keep the old values (a snapshot). Throws
        // Error(invalid_argument) when the cache is closed.
        void mark_written();
        void discard();        // drops the changes that were not marked
        bool changed() const;  // whether there are changes that were not marked

    private:
        friend class L2Cache;
        struct Inner;
        explicit Edit(std::unique_ptr<Inner> inner);
        std::unique_ptr<Inner> inner_;
    };

    // Throws Error(io) when the system gives no thread.
    explicit L2Cache(std::shared_ptr<const Tree> tree, const L2Options& options = {});
    explicit L2Cache(std::shared_ptr<ChunkStore> store, const L2Options& options = {});
    ~L2Cache();  // does not flush
    L2Cache(const L2Cache&) = delete;
    L2Cache& operator=(const L2Cache&) = delete;

    // The chunk with at least these columns; waits for the load. Throws what the load throws.
    Handle get(NodeId node, const ColumnSet& columns);

    // The chunk if it is resident with these columns, else an empty handle; never waits for a load.
    Handle find(NodeId node, const ColumnSet& columns);

    // Some segments of a chunk, as Tree::read_chunk_part, read past the cache. None when the cache holds changes of the
    // chunk: use get().
    std::optional<ChunkPart> read_part(NodeId node, const ColumnSet& columns,
                                       const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted);

    // Requests chunks in the background, in the order of the list; those that lie next to one on disk come with it, in
    // one read. A new list replaces the previous one: chunks of the
    // old list whose load has not begun are forgotten. `on_loaded` (may be empty) is called on a loader thread for each
    // chunk of the list, when it was loaded, was resident already, or failed; the chunk is pinned until it returns. It
    // must return quickly and must not call the cache's destructor.
    void request(std::vector<ChunkRequest> list, std::function<void(NodeId)> on_loaded = {});

    // Requests one more chunk in the background, before the current list: for sequential readers.
    void prefetch(const ChunkRequest& request);

    // The error of the last failed background load of this node, if any; a later success clears it.
    std::optional<std::string> error_of(NodeId node) const;

    // The chunk with these columns, to be changed. There is one Edit per node at a time; a second caller waits, so a
    // thread must not request a second Edit of a node. Throws what get() throws, Error(invalid_argument) when the store
    // is read-only, and, when the cache is full of changes that could not be written, the reason.
    Edit edit(NodeId node, const ColumnSet& columns);
    // Writes all changes to the store and commits them. Throws the first error; unless it is_done() (see
    // ChunkStore::commit), nothing is committed then, and another flush() tries again. Throws Error(invalid_argument)
    // when an Edit was dropped with changes that were not marked.
    void flush();
    // Flushes; from then on every call that returns points throws Error(invalid_argument).
    void close();
    // Closes without flush(): changes that were not committed are dropped.
    void abandon();
    // To be called after attributes were added to the store's tree.
    void take_schema();

    // Waits until the current list is done, and the writes that were started to make room.
    void wait_idle();
    // Drops every entry that is neither pinned nor changed.
    void clear();
    // Takes effect immediately; drops entries as necessary.
    void set_capacity(std::uint64_t bytes);
    std::uint64_t capacity() const;
    L2Statistics statistics() const;
    // The store's tree as of the last take_schema(); lives as long as the cache.
    const Tree& tree() const;

private:
    void start_loaders(unsigned threads);
    void end_loaders();
    std::shared_ptr<State> state_;
};

}  // namespace pcm
