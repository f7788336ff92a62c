// Rows of points in few bytes: how the builder keeps them on disk while it works.
//
// Made for speed, not for the smallest size: the columns of a block of rows are not separated. A row is read as a few
// words of 64 bits, each of one or more whole fields. Every field is stored as its difference to the smallest value of
// the block, and only the bits that vary in the block are stored, so constant fields take none. Words whose bits fit
// into 64 together are stored together, as a group.
//
// Block: per word u64 (the smallest values, each at its field's place), per field u8 (lowest bit that varies) and u8
// (how many bits from there are stored); then per group of words the rows' bits, padded to 8 bytes.
#pragma once

#include "pcm/build/bins/packing_loops.h"
#include "pcm/build/bins/row.h"
#include "pcm/cloud/attribute.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

class RowPacking {
public:
    static constexpr std::size_t block_rows = 512;

    RowPacking() = default;
    // For rows of this layout. `coordinates`: pack them too, and as signed numbers if `signed_coordinates`; the
    // attributes are always packed.
    RowPacking(const RowLayout& layout, const Schema& schema, bool coordinates, bool signed_coordinates = false);

    // Appends `count` rows, which begin row_bytes apart.
    void pack(const std::byte* rows, std::size_t count, std::vector<std::byte>& out) const;
    // The same for the rows numbered `order`, in this order.
    void pack(const std::byte* rows, const std::uint32_t* order, std::size_t count, std::vector<std::byte>& out) const;
    // Reads `count` rows back from exactly `size` bytes; coordinates that were not packed are left unchanged. Never
    // reads or writes out of bounds, whatever the bytes are; throws Error(corrupt) naming `path` for bytes that pack()
    // cannot have written.
    void unpack(const std::byte* data, std::size_t size, std::byte* rows, std::size_t count,
                const std::filesystem::path& path) const;

private:
    struct Field {
        int shift, bits;  // within the word
    };
    struct Word {
        std::size_t offset = 0;  // offset of its first byte in the row
        std::size_t bytes = 0;
        std::uint64_t sign = 0;  // turns signed numbers into unsigned ones of the same order
        std::vector<Field> fields;
    };
    struct Part {  // bits of a field as they are stored
        int from, length, to;
    };

    void add(std::size_t offset, std::size_t bytes, bool is_signed);
    template <class RowAt>
    void pack_block(const RowAt& row_at, std::size_t count, std::vector<std::byte>& out) const;
    const std::byte* unpack_block(const std::byte* data, const std::byte* end, std::byte* rows, std::size_t count,
                                  const std::filesystem::path& path) const;

    std::size_t row_bytes_ = 0;
    const PackingLoops* loops_ = nullptr;
    std::size_t header_bytes_ = 0;
    std::vector<Word> words_;
};

}  // namespace pcm
