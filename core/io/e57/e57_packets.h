// The points of one scan of an E57 file: one byte stream per field, split into packets. ASTM E2807-11, 9.3 and 9.4.
#pragma once

#include "pcm/io/e57/e57_file.h"
#include "pcm/system/error.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// One thread. `pages` and `scan` must outlive it.
class E57Packets {
public:
    // Throws Error(truncated | bad_format) when the section cannot hold the stated number of records.
    E57Packets(E57Pages& pages, const E57Scan& scan, std::string called);

    // Prepares the next `count` values of every field and discards the previous ones. Throws Error(truncated |
    // bad_format | corrupt) naming the byte.
    void prepare(std::size_t count);
    // The prepared values: raw ones of an integer field, or those of a float field.
    void integers(std::size_t field, std::int64_t* to);
    void floats(std::size_t field, double* to);

private:
    struct Stream {
        std::vector<std::byte> bytes;  // with padding, so that a whole number can be loaded anywhere
        std::size_t used = 0;          // bytes in use
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
    std::uint64_t end_ = 0;          // end of the section, logical
    std::uint64_t points_ = 0;       // up to the end of the prepared values
};

}  // namespace pcm
