// The columns of one chunk of a BpcArray, loaded from the cloud's file or the scratch file, or new and zero.
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

using Columns = std::vector<std::shared_ptr<Column>>;  // null: not loaded
using ColumnFlags = std::vector<std::uint8_t>;         // one flag per column

// The place of a chunk in the scratch file: room for all columns of `capacity` points, one after the other, raw. Only
// changed columns are filled in.
struct Spilled {
    std::uint64_t offset = 0;
    std::size_t points = 0;  // when it was last written
    ColumnFlags has;
    std::vector<std::uint64_t> checksums;
};

struct ChunkSource {
    const BpcFile* base = nullptr;
    std::optional<ChunkPlace> place;  // in base; none for a chunk that was never flushed
    const File* scratch = nullptr;
    std::optional<Spilled> spilled;
    std::size_t count = 0;     // points now
    std::size_t capacity = 0;  // points that a column needs room for
};

// The wanted columns, `capacity` points long, zero after the `count` points. May run on any thread while no other
// thread writes to the chunk's place in the scratch file.
Columns load_columns(const ChunkSource& source, const std::vector<Attribute>& shape, const ColumnFlags& wanted);

// Raw columns on disk, in a file without a name. Its space is freed only when the file is closed.
class ScratchFile {
public:
    // `cloud` is the cloud's file; the scratch file is made next to it, or in `folder` if that is not empty, at the
    // first use.
    ScratchFile(const std::filesystem::path& cloud, const std::filesystem::path& folder);
    void write(Spilled& slot, const std::vector<Attribute>& shape, std::size_t capacity, std::size_t column,
               const Column& values, std::size_t points);
    // A new place for a chunk.
    Spilled slot(const std::vector<Attribute>& shape, std::size_t capacity);
    const File& file() const { return file_; }
    void clear();

private:
    std::filesystem::path cloud_, folder_;
    File file_;
    std::uint64_t end_ = 0;
};

// Upper bound of the memory for encoding or decoding a chunk of `points` points, its columns not included.
std::size_t coding_bytes(const std::vector<Attribute>& shape, std::size_t points);

}  // namespace pcm::array
