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
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

// A chunk, or the segments of it that selected points can be in, and which of its points are selected.
struct SelectedChunk {
    NodeId node = no_node;
    Chunk chunk;
    std::size_t points = 0;               // the first ones of `chunk`: those of the level asked for
    bool all = true;                      // all of them are selected; else `selected` lists the selected ones
    std::vector<std::uint32_t> selected;  // ascending
    // Where the segments of `chunk` stand in the node's whole chunk: segment k begins at point `begins[k]` of `chunk`
    // and at point `first[k]` of the whole chunk. Empty when `chunk` is whole.
    std::vector<std::uint32_t> begins, first;

    std::size_t size() const { return all ? points : selected.size(); }
    std::size_t index(std::size_t i) const { return all ? i : selected[i]; }
    std::uint32_t number(std::size_t index) const;  // in the node's whole chunk

    L2Cache::Handle pin;  // handle of a chunk that came from the cache: keeps it there
};

// A chunk that the cache holds is used from there. Among the others, a chunk that the selection or the level cuts is
// read past the cache, and only those of its segments that selected points can be in; a whole chunk goes through the
// cache, unless all whole chunks together would take more than a quarter of it: reading everything once pushes nothing
// out. Memory: at most `in_flight` chunks, the one that next() returned among them. The caller's thread reads too, so
// in_flight - 1 threads of the pool are asked for. One thread calls; the cache, the pool and the rates outlive the
// stream. The destructor waits for the reads that run, and drops the others.
class ChunkStream {
public:
    ChunkStream(L2Cache& cache, TaskPool& pool, ReadRates& rates, Selector selector,
                const std::optional<std::uint16_t>& level, const ColumnSet& columns, unsigned in_flight);
    ~ChunkStream();
    ChunkStream(const ChunkStream&) = delete;
    ChunkStream& operator=(const ChunkStream&) = delete;

    // The next chunk with selected points; null at the end. It lives until the next call. Throws what reading the chunk
    // threw; the call after that resumes behind this chunk.
    const SelectedChunk* next();

    const std::vector<SelectedNode>& nodes() const { return nodes_; }
    const SourceRounding& rounding() const { return rounding_; }  // rounding of the tree's positions
    double fraction() const;  // share of the nodes that were returned or passed over

    // Totals over chunks that were returned or passed over.
    std::uint64_t points_read() const { return points_read_; }  // decoded, selected or not
    std::uint64_t bytes_read() const { return bytes_read_; }    // from disk, past the cache
    std::uint64_t chunks() const { return chunks_; }
    std::uint64_t cached() const { return cached_; }  // chunks that came out of the cache

private:
    struct Job {
        SelectedNode node;
        SelectedChunk result;
        std::uint64_t bytes = 0;
        double seconds = 0;
        bool cached = false;
        std::shared_ptr<Task> task;
    };
    bool fills_cache() const;
    void read(Job& job) const;
    void select(Job& job, const std::vector<BoxRelation>& relations) const;

    L2Cache& cache_;
    TaskPool& pool_;
    ReadRates& rates_;
    Selector selector_;
    const SourceRounding rounding_;
    std::optional<std::uint16_t> level_;
    ColumnSet columns_;
    Box3i box_;  // grid positions; no point outside of it is selected
    std::size_t in_flight_;
    std::vector<SelectedNode> nodes_;
    bool passes_cache_;                       // whole chunks are not kept
    std::size_t next_ = 0;                    // index in nodes_ of the first without a job
    std::deque<std::unique_ptr<Job>> ahead_;  // submitted, not returned
    std::unique_ptr<Job> current_;
    std::uint64_t chunks_ = 0, points_read_ = 0, bytes_read_ = 0, cached_ = 0;
};

// Bytes per point that the columns of a set take in memory.
std::uint64_t decoded_bytes(const Tree& tree, const ColumnSet& columns);

}  // namespace pcm
