// L2: decoded chunks of one tree in RAM, between the disk and everybody who reads or changes points.
//
// Bytes are charged for the decoded columns an entry holds; when the sum exceeds the capacity, the least recently used
// entries that nobody holds are dropped. A handle pins its entry. Loads run on the cache's own threads or the caller's;
// a chunk that several clients ask for at once is loaded once.
//
// Changed chunks are written to the store before they are dropped, by whoever needs the room, and all of them by
// flush(). One that cannot be written stays, however much there is; flush() says why, and edit() when there is no room
// left for more.
//
// Errors of a load are thrown to the caller that asked (get, edit) or counted and kept for error_of() (request). All
// members are safe to call from any number of threads.
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
    unsigned threads = 1;  // loader threads
};

// What the cache did since it was made. A miss is compulsory when the columns were never loaded before, capacity when
// they had been and were dropped, forced when a synchronous caller had to wait for a load.
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
    std::uint64_t dirty_bytes = 0;  // of changed columns that are not written yet
    std::uint64_t written_chunks = 0;
    std::uint64_t written_bytes = 0;  // of the columns that had been changed, decoded
    std::uint64_t failed_writes = 0;
    double write_seconds = 0;  // summed over threads
};

struct ChunkRequest {
    NodeId node = no_node;
    ColumnSet columns;
};

class L2Cache {
    struct Entry;
    struct State;

public:
    // Keeps the chunk in the cache while it lives, as it was when it was asked for. May outlive the cache.
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

    // A chunk in change. One thread.
    class Edit {
    public:
        Edit(Edit&&) noexcept;
        Edit& operator=(Edit&&) noexcept;
        ~Edit();  // what was changed and not marked is dropped; unless an exception is on its way, the next flush()
                  // says so
        const Chunk& chunk() const;  // with what was marked so far
        // A copy of one's own to change; of a column that was asked for. Its size must stay.
        Column& column(std::size_t attribute);
        // The changed columns become the cache's. Whoever holds the chunk keeps what he has. Throws
        // Error(invalid_argument) when the cache is closed.
        void mark_written();
        void discard();        // the changed columns are dropped
        bool changed() const;  // and not marked since

    private:
        friend class L2Cache;
        struct Inner;
        explicit Edit(std::unique_ptr<Inner> inner);
        std::unique_ptr<Inner> inner_;
    };

    explicit L2Cache(std::shared_ptr<const Tree> tree, const L2Options& options = {});
    explicit L2Cache(std::shared_ptr<ChunkStore> store, const L2Options& options = {});
    ~L2Cache();  // flushes nothing
    L2Cache(const L2Cache&) = delete;
    L2Cache& operator=(const L2Cache&) = delete;

    // The chunk with at least these columns; waits for the load. Throws what the load threw.
    Handle get(NodeId node, const ColumnSet& columns);

    // The chunk if it is resident with these columns, else an empty handle; never waits for a load.
    Handle find(NodeId node, const ColumnSet& columns);

    // Some segments of a chunk, as Tree::read_chunk_part; past the cache. Nothing when the chunk is in the cache and
    // changed: get() it.
    std::optional<ChunkPart> read_part(NodeId node, const ColumnSet& columns,
                                       const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted);

    // Asks for chunks in the background, first ones first. A newer list replaces the older one: what the older list
    // asked for and no loader has begun is forgotten. `on_loaded` (may be empty) is called on a loader thread each time
    // a chunk of the list has arrived (or was there already) or failed; it must return quickly and must not call the
    // cache's destructor.
    void request(std::vector<ChunkRequest> list, std::function<void(NodeId)> on_loaded = {});

    // Asks for one more chunk in the background, beside and before the current list: for those who read chunk after
    // chunk.
    void prefetch(const ChunkRequest& request);

    // The error of the last failed background load of this node, if any; a later success clears it.
    std::optional<std::string> error_of(NodeId node) const;

    // The chunk with these columns, to be changed. One Edit a node at a time: a second caller waits, so a thread that
    // holds one must not ask for another one of the same node. Throws what get() throws, Error(invalid_argument) when
    // the store cannot be written to, and, when the cache is full of changes that could not be written, why not.
    Edit edit(NodeId node, const ColumnSet& columns);
    // Writes all that is changed to the store and commits it. Throws the first error; nothing is committed then, and
    // what could not be written stays for another flush(). Throws Error(invalid_argument) when an Edit was dropped with
    // changes that were not marked.
    void flush();
    // flush(), and from then on every call that wants points throws Error(invalid_argument).
    void close();
    // The same without flush(): what was not committed is dropped.
    void abandon();
    // The store's tree has got attributes.
    void take_schema();

    // Waits until the current list has been worked off, and the writing that letting go of chunks has brought about.
    void wait_idle();
    // Drops every entry that nobody holds and that is not changed.
    void clear();
    // Takes effect at once; entries are dropped if need be.
    void set_capacity(std::uint64_t bytes);
    L2Statistics statistics() const;
    // Its nodes and, as far as take_schema() was told, its schema; lives as long as the cache.
    const Tree& tree() const;

private:
    std::shared_ptr<State> state_;
};

}  // namespace pcm
