// Writes a file of a whole cloud: cloud block, chunks, chunk table.
#pragma once

#include "pcm/bpc/cloud_block.h"
#include "pcm/system/output_file.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pcm {

// The default number of points in a chunk of a cloud: 100,000, fewer where points are large.
std::size_t default_cloud_chunk_points(const Schema& schema);

// For one thread. finish() gives the file its name atomically: before it the name refers to the previous file, if any.
// Memory: the cloud block twice and 16 bytes per chunk.
class BpcFileWriter {
public:
    // Position type, grid, schema and metadata are taken from `cloud`. Throws Error(invalid_argument) for a grid
    // without positive scales and finite offsets, Error(unsupported) for more metadata than a file can hold, and what
    // opening a file throws.
    BpcFileWriter(const std::filesystem::path& path, const BpcCloud& cloud);

    // A chunk from encode_batch() or from another file of a cloud with the same grid and schema. Its header is decoded
    // again for its number of points and its box.
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
