// What lies in the data files of a tree, found without its index.
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

// A chunk or a tombstone whose header is whole.
struct FoundChunk {
    PartNode node;  // its box is that of its own points; without points: a tombstone
    std::uint32_t generation = 1;
};

struct FoundFile {
    std::filesystem::path path;
    std::uint32_t number = 0;
    std::uint64_t size = 0;
    std::vector<FoundChunk> chunks;      // in their order
    std::optional<CommitRecord> commit;  // the last one
    std::vector<std::string> faults;     // stretches that are nothing known
};

// The data files in a tree's folder, by number.
std::vector<FoundFile> list_data_files(const std::filesystem::path& folder);

// Goes from chunk to chunk, and where there is none on to the next that begins with a header whose checksum holds.
// Columns are not looked at. Chunks that are of no tree, or of one with another grid or schema than `expected` tells,
// are faults. `tick(bytes)` is called after each chunk.
struct ChunkKind {
    Schema schema;
    Grid grid;
};
void scan(FoundFile& file, std::optional<ChunkKind>& expected, const std::function<void(std::uint64_t)>& tick);

}  // namespace pcm
