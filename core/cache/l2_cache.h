// L2: decoded chunks of one tree in RAM, between the disk and everybody who reads points.
//
// Bytes are charged for the decoded columns an entry holds; when the sum exceeds the capacity, the least recently used
// entries that nobody holds are dropped. A handle pins its entry. Loads run on the cache's own threads; a chunk that
// several clients ask for at once is loaded once. Errors of a load are thrown to the caller that asked (get) or counted
// and kept for error_of() (request). All members are safe to call from any number of threads.
#pragma once

#include "tree/tree.h"

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
    std::uint64_t loaded_bytes = 0;    // decoded
    double load_seconds = 0;           // summed over loader threads
    std::uint64_t resident_bytes = 0;
    std::uint64_t resident_chunks = 0;
};

struct ChunkRequest {
    NodeId node = no_node;
    ColumnSet columns;
};

class L2Cache {
    struct Entry;
    struct State;

public:
    // Keeps the chunk in the cache while it lives. May outlive the cache.
    class Handle {
    public:
        Handle() = default;
        explicit operator bool() const { return chunk_ != nullptr; }
        const Chunk& operator*() const { return *chunk_; }
        const Chunk* operator->() const { return chunk_.get(); }

    private:
        friend class L2Cache;
        std::shared_ptr<const Chunk> chunk_;
        std::shared_ptr<void> pin_;
    };

    explicit L2Cache(std::shared_ptr<const Tree> tree, const L2Options& options = {});
    ~L2Cache();
    L2Cache(const L2Cache&) = delete;
    L2Cache& operator=(const L2Cache&) = delete;

    // The chunk with at least these columns; waits for the load. Throws what the load threw.
    Handle get(NodeId node, const ColumnSet& columns);

    // The chunk if it is resident with these columns, else an empty handle; never waits for a load.
    Handle find(NodeId node, const ColumnSet& columns);

    // Asks for chunks in the background, first ones first. A newer list replaces the older one: what the older list
    // asked for and no loader has begun is forgotten. `on_loaded` (may be empty) is called on a loader thread each time
    // a chunk of the list has arrived (or was there already) or failed; it must return quickly and must not call the cache's destructor.
    void request(std::vector<ChunkRequest> list, std::function<void(NodeId)> on_loaded = {});

    // Asks for one more chunk in the background, beside and before the current list: for those who read chunk after chunk.
    void prefetch(const ChunkRequest& request);

    // The error of the last failed background load of this node, if any; a later success clears it.
    std::optional<std::string> error_of(NodeId node) const;

    // Waits until the current list has been worked off.
    void wait_idle();
    // Drops every entry that nobody holds.
    void clear();
    // Takes effect at once; entries are dropped if need be.
    void set_capacity(std::uint64_t bytes);
    L2Statistics statistics() const;
    const Tree& tree() const;

private:
    std::shared_ptr<State> state_;
};

}  // namespace pcm
