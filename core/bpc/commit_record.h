// The record that ends a generation of a tree. It stands at the end of the generation's last data file and shows that
// the generation was written completely. The layout is in FORMAT.md.
#pragma once

#include "pcm/system/byte_source.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

struct CommitRecord {
    std::uint32_t generation = 1;
    bool coverage_kept = true;  // as TreeInfo::coverage_kept
    std::uint64_t points = 0;   // all numbers describe the whole tree in this generation
    std::uint64_t content_hash = 0;
    std::uint32_t parts = 0;
    std::uint32_t chunks = 0;  // nodes with a chunk
    struct DataFile {
        std::uint64_t bytes = 0;       // in use; 0: none of its chunks is in use
        std::uint32_t generation = 1;  // the generation that wrote it
        bool operator==(const DataFile& o) const { return bytes == o.bytes && generation == o.generation; }
    };
    std::vector<DataFile> data_files;  // the bytes of this record count as in use
};

std::vector<std::byte> encode_commit(const CommitRecord& record);
std::size_t commit_bytes(std::size_t data_files);  // size of a record that lists that many data files

// The record that begins at `offset`, where `available` bytes can be read; none when no record begins there. `bytes`
// receives its length. Throws Error(corrupt | truncated | unsupported | io), naming the file and the byte.
std::optional<CommitRecord> read_commit(const ByteSource& file, std::uint64_t offset, std::uint64_t available,
                                        std::uint64_t& bytes);

}  // namespace pcm
