// A file of a whole cloud, open for reading: chunks one after another, a cloud block before them or not. In a data file
// of a tree there may also be tombstones and commit records: they are passed over.
#pragma once

#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_index.h"
#include "pcm/bpc/cloud_block.h"
#include "pcm/system/error.h"

#include <cstdint>
#include <filesystem>

namespace pcm {

// Any number of threads at once, after the constructor. Memory: the cloud block, at most 24 MB of places, and what a
// call decodes; the file's numbers are checked against its bytes before anything is sized by them.
class BpcFile {
public:
    // With a cloud block the table says where the chunks are; without one this hops over all of their headers, which
    // costs one read each. All chunks must have one schema. Throws Error(not_found | permission | truncated | corrupt |
    // unsupported).
    explicit BpcFile(const std::filesystem::path& path);

    const File& file() const { return file_; }
    bool has_block() const { return has_block_; }
    // Of a file without a block it is put together from the chunks' headers: no metadata, and the position type is f64
    // unless all lie on one grid.
    const BpcCloud& cloud() const { return cloud_; }
    const ChunkIndex& index() const { return index_; }

    // The place of the chunk that holds the point, which must exist. Few hops over headers, none when
    // index().knows_every_chunk().
    ChunkPlace find(std::uint64_t point) const;
    // The place of the next chunk, or the end.
    ChunkPlace after(const ChunkPlace& place, const BpcHeader& header) const;

    // The header of the chunk at a place, and the chunk: checked against what the file says about it elsewhere, and
    // refused when its columns would take more than most_decoded_bytes. Throws Error(truncated | corrupt | unsupported
    // | io).
    BpcHeader header(const ChunkPlace& place) const;
    DecodedChunk read(const ChunkPlace& place, const ColumnSet& columns) const;

    static constexpr std::uint64_t most_decoded_bytes = std::uint64_t{96} << 20;

private:
    void hop();
    std::uint64_t bytes_to_pass(std::uint64_t offset, std::uint64_t end) const;
    void check(const ChunkPlace& place, const BpcHeader& header) const;
    [[noreturn]] void fail(ErrorCode code, const ChunkPlace& place, const std::string& what) const;

    File file_;
    bool has_block_ = false;
    BpcCloud cloud_;
    ChunkIndex index_;
};

}  // namespace pcm
