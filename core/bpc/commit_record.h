// The record that ends a generation of a tree: after it, in the last data file of the generation, nothing is missing.
// The layout is in FORMAT.md.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

struct CommitRecord {
    std::uint32_t generation = 1;
    bool coverage_kept = true;  // as TreeInfo::coverage_kept
    std::uint64_t points = 0;   // of the whole tree in this generation, as are all numbers here
    std::uint64_t content_hash = 0;
    std::uint32_t parts = 0;
    std::uint32_t chunks = 0;  // that nodes have
    struct DataFile {
        std::uint64_t bytes = 0;       // 0: none of its chunks is in use
        std::uint32_t generation = 1;  // that wrote it
        bool operator==(const DataFile& o) const { return bytes == o.bytes && generation == o.generation; }
    };
    std::vector<DataFile> data_files;  // the record's own bytes are counted in its file
};

std::vector<std::byte> encode_commit(const CommitRecord& record);
std::size_t commit_bytes(std::size_t data_files);  // of a record that names so many

// The record that begins at `offset`, of which `available` bytes can be read; none when no record begins there. `bytes`
// gets its length. Throws Error(corrupt | truncated | unsupported | io), naming the file and the byte.
std::optional<CommitRecord> read_commit(const File& file, std::uint64_t offset, std::uint64_t available,
                                        std::uint64_t& bytes);

}  // namespace pcm
