// The points of one scan of an E57 file: byte streams, one a field, cut into packets. ASTM E2807-11, 9.3 and 9.4.
#pragma once

#include "pcm/system/error.h"
#include "pcm/io/e57/e57_file.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// One thread. `pages` and `scan` outlive it.
class E57Packets {
public:
    // Throws Error(truncated | bad_format) when the section cannot hold the promised records.
    E57Packets(E57Pages& pages, const E57Scan& scan, std::string called);

    // Makes the next `count` values of every field ready; the ones before are gone. Throws Error(truncated | bad_format
    // | corrupt) naming the byte.
    void prepare(std::size_t count);
    // Of the prepared values, raw ones of an integer field, or those of a float field.
    void integers(std::size_t field, std::int64_t* to);
    void floats(std::size_t field, double* to);

private:
    struct Stream {
        std::vector<std::byte> bytes;  // with some more behind, so that a number can be loaded whole
        std::size_t used = 0;          // of them
        std::uint64_t bit = 0;         // where the prepared values begin
    };

    [[noreturn]] void fail(ErrorCode code, const std::string& what) const;
    void read_packet();
    void append(Stream& stream, std::size_t bytes, std::uint64_t at);

    E57Pages& pages_;
    const E57Scan& scan_;
    const std::string called_;
    std::vector<unsigned> bits_;
    std::vector<Stream> streams_;
    std::size_t prepared_ = 0;
    std::uint64_t next_packet_ = 0;  // logical
    std::uint64_t end_ = 0;          // of the section, logical
    std::uint64_t points_ = 0;       // behind the prepared values
};

}  // namespace pcm
