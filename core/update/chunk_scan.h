// Finds the chunks in the data files of a tree without its index.
#pragma once

#include "pcm/bpc/commit_record.h"
#include "pcm/update/part_nodes.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct BpcHeader;

// A chunk or a tombstone with an undamaged header.
struct FoundChunk {
    PartNode node;  // its box is that of its own points; a node without points stands for a tombstone
    std::uint32_t generation = 1;
};

struct FoundFile {
    std::filesystem::path path;
    std::uint32_t number = 0;
    std::uint64_t size = 0;
    std::vector<FoundChunk> chunks;      // in the order of the file
    std::optional<CommitRecord> commit;  // the last one
    std::vector<std::string> faults;     // ranges of bytes that are neither chunks nor commit records
    std::uint64_t other_chunks = 0;      // undamaged, but of another tree or of no tree
};

// The data files in a tree's folder, by number; anything but a regular file is left out.
std::vector<FoundFile> list_data_files(const std::filesystem::path& folder);

// What all chunks of a tree have in common.
struct ChunkKind {
    Schema schema;
    Grid grid;
};
// Whether a chunk with this header can be of a tree of this kind. Later chunks may have more attributes than earlier
// ones.
bool is_of(const BpcHeader& header, const ChunkKind& expected);

// Reads the headers from chunk to chunk; where none begins it searches for the next header whose checksum matches.
// Columns are not read. Chunks of no tree, or of a tree with another grid or schema than `expected`, are faults. An
// empty `expected` takes its value from the first chunk. `tick(bytes)` is called after each chunk.
void scan(FoundFile& file, std::optional<ChunkKind>& expected, const std::function<void(std::uint64_t)>& tick);

}  // namespace pcm
