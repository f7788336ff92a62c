// Writes a file of a whole cloud: cloud block, chunks, chunk table.
#pragma once

#include "pcm/bpc/cloud_block.h"
#include "pcm/system/output_file.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pcm {

// As many points as a chunk of a cloud has unless there is a reason for another number: 100,000, fewer where points are
// large.
std::size_t default_chunk_points(const Schema& schema);

// One thread. The file appears under its name only when finish() returns: at any instant the name stands for what was
// there before or for the whole new cloud. Memory: the cloud block twice and 16 bytes a chunk.
class BpcFileWriter {
public:
    // Of `cloud` the position type, grid, schema and metadata are taken. Throws Error(invalid_argument) for a grid
    // without positive scales and finite offsets, Error(unsupported) for more metadata than a file can hold, and what
    // opening can throw.
    BpcFileWriter(const std::filesystem::path& path, const BpcCloud& cloud);

    // A chunk that encode_batch() made or that stood in another file of a cloud of the same grid and schema; its header
    // is decoded again for its numbers of points and its box.
    void append(const std::vector<std::byte>& chunk);
    std::uint64_t points() const { return cloud_.points; }
    void finish();

private:
    BpcCloud cloud_;
    OutputFile out_;
    std::vector<ChunkSize> chunks_;
    Box3d box_;
    bool finite_ = true;
};

}  // namespace pcm
