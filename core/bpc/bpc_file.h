// A file of a whole cloud, open for reading: chunks one after another, with or without a cloud block before them.
// Tombstones and commit records, which data files of a tree may have, are skipped.
#pragma once

#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_index.h"
#include "pcm/bpc/cloud_block.h"
#include "pcm/system/error.h"

#include <cstdint>
#include <filesystem>

namespace pcm {

// Any number of threads may call after the constructor. Memory: the cloud block, at most 24 MB of places, and what a
// call decodes. Numbers in the file are checked against its size before memory is allocated by them.
class BpcFile {
public:
    // With a cloud block the chunk table has the places of the chunks; without one all their headers are read, one read
    // per chunk. All chunks must have the same schema. Throws Error(not_found | permission | truncated | corrupt |
    // unsupported).
    explicit BpcFile(const std::filesystem::path& path);

    const File& file() const { return file_; }
    // For a file without a block it is derived from the chunks' headers: without metadata, and with position type f64
    // unless all chunks are on one grid.
    const BpcCloud& cloud() const { return cloud_; }
    const ChunkIndex& index() const { return index_; }

    // The place of the chunk that holds the point, which must exist. Reads few headers, none when
    // index().knows_every_chunk().
    ChunkPlace find(std::uint64_t point) const;
    // The place of the next chunk, or the end.
    ChunkPlace after(const ChunkPlace& place, const BpcHeader& header) const;

    // The header of the chunk at a place, and the chunk itself. Both are checked against the block and the table, and
    // refused when the decoded columns would take more than most_decoded_bytes. Throws Error(truncated | corrupt |
    // unsupported | io).
    BpcHeader header(const ChunkPlace& place) const;
    DecodedChunk read(const ChunkPlace& place, const ColumnSet& columns) const;

    static constexpr std::uint64_t most_decoded_bytes = std::uint64_t{96} << 20;

private:
    void read_headers();
    std::uint64_t bytes_to_skip(std::uint64_t offset, std::uint64_t end) const;
    void check(const ChunkPlace& place, const BpcHeader& header) const;
    [[noreturn]] void fail(ErrorCode code, const ChunkPlace& place, const std::string& what) const;

    File file_;
    bool has_block_ = false;
    BpcCloud cloud_;
    ChunkIndex index_;
};

}  // namespace pcm
