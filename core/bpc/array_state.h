// The inside of BpcArray: the columns in memory, and the scratch file for changed columns that were evicted. For
// bpc_array.cpp and array_state.cpp only.
#pragma once

#include "pcm/bpc/array_chunk.h"
#include "pcm/bpc/bpc_array.h"
#include "pcm/threads/task_pool.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <list>
#include <memory>
#include <unordered_map>
#include <vector>

namespace pcm {

// A chunk with columns in memory.
struct BpcArray::Resident {
    std::uint64_t chunk = 0;
    std::size_t capacity = 0;  // points that its columns have room for
    array::Columns columns;
    std::vector<std::byte*> data;  // values of the columns that were used
    array::ColumnFlags changed;
    std::size_t bytes = 0;  // size of all loaded columns
    bool grows = false;     // all columns are loaded, used and changed
};

// Invariants. `first` has one element more than there are chunks; the last one is size_. A changed column is in memory
// or in the scratch file; the one in memory is newer. The window is the first resident, or there is none (count_ == 0).
// The chunk that is read ahead is not resident.
struct BpcArray::State {
    using Place = std::list<Resident>::iterator;

    State(const std::filesystem::path& file, const BpcArrayOptions& choices)
        : path(file), options(choices), scratch(file, choices.scratch_folder)
    {
    }

    std::filesystem::path path;
    BpcArrayOptions options;
    std::vector<Attribute> shape;
    std::size_t row_bytes = 0;
    std::size_t metadata_bytes = 0;
    std::size_t chunk_points = 0;
    std::size_t largest_chunk = 0;  // points
    std::unique_ptr<BpcFile> base;
    std::vector<std::uint64_t> first{0};
    double chunks_a_point = 0;      // 1 / number of points of the first chunk
    std::list<Resident> residents;  // most recently used first
    std::vector<Place> where;       // place of each chunk; residents.end() if not resident
    std::size_t resident_bytes = 0;
    std::unordered_map<std::uint64_t, array::Spilled> spilled;
    array::ScratchFile scratch;
    array::ColumnFlags expected;  // the columns that were used of the last window
    std::uint64_t last_opened = std::numeric_limits<std::uint64_t>::max() - 1;
    std::uint64_t ahead_chunk = 0;
    TaskPool pool;
    Pending<array::Columns> ahead;  // last: its destructor waits while all that the task uses still exists

    std::uint64_t chunks() const { return first.size() - 1; }
    std::size_t count(std::uint64_t chunk) const { return static_cast<std::size_t>(first[chunk + 1] - first[chunk]); }
    // Only the last chunk can grow.
    std::size_t capacity(std::uint64_t chunk) const
    {
        return chunk + 1 == chunks() ? std::max(count(chunk), chunk_points) : count(chunk);
    }
    // Memory for everything but resident columns: the tables of chunks, encoding, the output's buffer, and the chunk
    // that is read ahead.
    std::size_t overhead(bool with_ahead) const
    {
        const std::size_t coding = array::coding_bytes(shape, largest_chunk);
        const std::size_t a_chunk = 200 + 9 * shape.size();
        constexpr std::size_t output_buffer = std::size_t{1} << 20;
        return chunks() * a_chunk + 4 * metadata_bytes + output_buffer + coding +
               (with_ahead ? coding + largest_chunk * row_bytes : 0);
    }
    bool reads_ahead() const
    {
        return options.read_ahead && options.memory_bytes >= overhead(true) + 2 * largest_chunk * row_bytes;
    }
    std::size_t resident_limit() const
    {
        return options.memory_bytes - std::min(options.memory_bytes, overhead(reads_ahead()));
    }

    void set_up(const BpcCloud& cloud);
    void check_memory() const;
    array::ChunkSource source(std::uint64_t chunk) const;
    std::uint64_t chunk_of(std::uint64_t index) const;
    void add_resident(std::uint64_t chunk);
    void make_room(std::size_t bytes, Statistics& statistics);
    void spill(Resident& resident, Statistics& statistics);
    void install(Resident& resident, array::Columns columns, Statistics& statistics);
    void load_missing(array::ColumnFlags wanted, Statistics& statistics);
    void read_ahead_of(std::uint64_t chunk);
    void drop_ahead();
    bool is_changed(std::uint64_t chunk) const;
    std::vector<std::byte> encoded(Resident& resident, const BpcCloud& cloud) const;
};

}  // namespace pcm
