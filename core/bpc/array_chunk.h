// Columns of one chunk of a BpcArray, from where they are: the cloud's file, the scratch file, or nowhere yet.
#pragma once

#include "pcm/bpc/bpc_file.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace pcm::array {

// The columns of an array: x, y, z (i32 on a grid, else f64), then the attributes.
std::vector<Attribute> columns_of(const BpcCloud& cloud);

using Columns = std::vector<std::shared_ptr<Column>>;  // null: not there
using ColumnFlags = std::vector<std::uint8_t>;         // by column

// What of a chunk is in the scratch file: room for all columns of `capacity` points, one after the other, raw; filled
// in are those that have been changed.
struct Spilled {
    std::uint64_t offset = 0;
    std::size_t points = 0;  // when it was written last
    ColumnFlags has;
    std::vector<std::uint64_t> checksums;
};

struct ChunkSource {
    const BpcFile* base = nullptr;
    std::optional<ChunkPlace> place;  // in base; none for a chunk that was never flushed
    const File* scratch = nullptr;
    std::optional<Spilled> spilled;
    std::size_t count = 0;     // points now
    std::size_t capacity = 0;  // points that a column shall have room for
};

// The wanted columns, `capacity` points long, zero behind the `count` points. May run on any thread while nobody writes
// to the part of the scratch file that belongs to the chunk.
Columns load_columns(const ChunkSource& source, const std::vector<Attribute>& shape, const ColumnFlags& wanted);

// Raw columns on disk, in room that is never given back before the file is closed. The file has no name.
class ScratchFile {
public:
    // `beside` is the cloud's file; made when first used.
    ScratchFile(const std::filesystem::path& beside, const std::filesystem::path& folder);
    void write(Spilled& slot, const std::vector<Attribute>& shape, std::size_t capacity, std::size_t column,
               const Column& values, std::size_t points);
    // Room for a chunk that has none.
    Spilled slot(const std::vector<Attribute>& shape, std::size_t capacity);
    const File& file() const { return file_; }
    void clear();

private:
    std::filesystem::path beside_, folder_;
    File file_;
    std::uint64_t end_ = 0;
};

// Upper bound of what coding or decoding a chunk of so many points takes, beside its columns.
std::size_t coding_bytes(const std::vector<Attribute>& shape, std::size_t points);

}  // namespace pcm::array
