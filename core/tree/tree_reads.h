// What has been read of a tree's chunks: how many, which columns, how many bytes.
#pragma once

#include "pcm/bpc/chunk.h"

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace pcm {

// Since the tree was opened. Chunks that are read again count again.
struct TreeReads {
    std::uint64_t chunks = 0;             // reads of a chunk, or of some of its segments
    std::uint64_t points = 0;             // number of points decoded
    std::uint64_t bytes = 0;              // size of headers and columns, as they are stored
    ColumnSet columns{false, false, {}};  // every column that was decoded at least once
};

// Names of the columns: "positions", "sizes", and the attributes.
std::vector<std::string> names_of(const ColumnSet& columns, const Schema& schema);

// Any number of threads.
class TreeReadCounter {
public:
    void add(const Chunk& chunk, std::uint64_t bytes);  // counts the points for the process too (system/work_done.h)
    TreeReads reads() const;

private:
    mutable std::mutex mutex_;
    TreeReads reads_;
};

}  // namespace pcm
