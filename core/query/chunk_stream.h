// The chunks that a selection touches, one after the other, with the selected points of each; read ahead by the threads
// of a pool.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/selection.h"
#include "pcm/query/read_rates.h"
#include "pcm/threads/task_pool.h"
#include "pcm/tree/selected_nodes.h"

#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

// A chunk, or those of its segments that selected points can be in, and which of its points are selected.
struct SelectedChunk {
    NodeId node = no_node;
    Chunk chunk;
    std::size_t points = 0;               // of `chunk`, from its first on, that are of the level asked for
    bool all = true;                      // all of them are selected; else `selected`
    std::vector<std::uint32_t> selected;  // ascending
    // Where the parts of `chunk` stand in the node's whole chunk: part k begins at `begins[k]` in `chunk` and at
    // `first[k]` there.
    std::vector<std::uint32_t> begins, first;

    std::size_t size() const { return all ? points : selected.size(); }
    std::size_t index(std::size_t i) const { return all ? i : selected[i]; }
    std::uint32_t number(std::size_t index) const;  // in the node's whole chunk

    L2Cache::Handle pin;  // keeps what came from the cache in it
};

// A chunk that the cache holds is used from there. Of others, those that the selection or the level cuts are read past
// the cache, and of them alone the segments that selected points can be in; whole ones go through the cache. Memory: at
// most `in_flight` chunks beside the one that next() gave. One thread calls; the tree, the cache, the pool and the
// rates outlive the stream.
class ChunkStream {
public:
    ChunkStream(L2Cache& cache, TaskPool& pool, ReadRates& rates, Selector selector,
                const std::optional<std::uint16_t>& level, const ColumnSet& columns, unsigned in_flight);
    ~ChunkStream();
    ChunkStream(const ChunkStream&) = delete;
    ChunkStream& operator=(const ChunkStream&) = delete;

    // The next chunk with selected points; null at the end. It lives until the next call. Throws what reading threw.
    const SelectedChunk* next();

    const std::vector<SelectedNode>& nodes() const { return nodes_; }
    double fraction() const;  // of the nodes that were looked at

    // So far, of chunks that were given or passed over.
    std::uint64_t points_read() const { return points_read_; }  // decoded, selected or not
    std::uint64_t bytes_read() const { return bytes_read_; }    // from disk, as far as not through the cache
    std::uint64_t chunks() const { return chunks_; }
    std::uint64_t cached() const { return cached_; }  // chunks that came out of the cache

private:
    struct Job {
        SelectedNode node;
        SelectedChunk result;
        std::exception_ptr error;
        std::uint64_t bytes = 0;
        double seconds = 0;
        bool cached = false;
        std::shared_ptr<Task> task;
    };
    void read(Job& job) const;
    void select(Job& job, const std::vector<BoxRelation>& relations) const;

    L2Cache& cache_;
    TaskPool& pool_;
    ReadRates& rates_;
    Selector selector_;
    std::optional<std::uint16_t> level_;
    ColumnSet columns_;
    Box3i box_;  // no point outside of it is selected
    std::size_t in_flight_;
    std::vector<SelectedNode> nodes_;
    std::size_t next_ = 0;                    // of nodes_, to be asked for
    std::deque<std::unique_ptr<Job>> ahead_;  // asked for, not given
    std::unique_ptr<Job> current_;
    std::uint64_t chunks_ = 0, points_read_ = 0, bytes_read_ = 0, cached_ = 0;
};

// Bytes that the columns of a set take in memory, a point.
std::uint64_t decoded_bytes(const Tree& tree, const ColumnSet& columns);

}  // namespace pcm
