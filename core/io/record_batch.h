// Points as a file has them: records of one length, undecoded.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace pcm {

// Where the value of an attribute is in a record: whole bytes, or bits of one byte.
struct FieldPlace {
    std::size_t offset = 0;
    std::size_t bytes = 0;  // size of all components
    unsigned shift = 0;
    unsigned mask = 0;  // not 0: one byte, (byte >> shift) & mask
};

struct RecordBatch {
    std::vector<std::byte> bytes;  // the records, one after the other; more bytes may follow
    std::size_t size = 0;          // number of points
    std::size_t stride = 0;        // bytes of a record
    // Each record begins with three coordinates on the reader's grid, std::int32_t, little-endian. The attributes of
    // its schema, in this order:
    std::shared_ptr<const std::vector<FieldPlace>> fields;
};

}  // namespace pcm
