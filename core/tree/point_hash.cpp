#include "pcm/tree/point_hash.h"

#include "pcm/bpc/checksum.h"

#include <cstring>

namespace pcm {

RowLayout::RowLayout(const Schema& schema, bool wide) : coordinate_bytes(wide ? 8 : 4), bytes(3 * coordinate_bytes)
{
    for (const Attribute& attribute : schema) {
        offsets.push_back(bytes);
        sizes.push_back(attribute.bytes());
        bytes += attribute.bytes();
    }
}

std::uint64_t hash_rows(const std::byte* rows, std::size_t count, std::size_t row_bytes)
{
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += checksum(rows + i * row_bytes, row_bytes);
    return sum;
}

namespace {

template <class Coord>
void put_coordinates(const ChunkPositions& positions, std::size_t row_bytes, std::byte* rows)
{
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Coord c = to_coordinate<Coord>(positions.grid(i, a));
            std::memcpy(rows + i * row_bytes + a * sizeof(Coord), &c, sizeof c);
        }
}

}  // namespace

std::uint64_t hash_chunk(const Chunk& chunk, const RowLayout& layout, std::vector<std::byte>& scratch)
{
    scratch.resize(chunk.points * layout.bytes);
    if (layout.coordinate_bytes == 4)
        put_coordinates<std::uint32_t>(*chunk.positions, layout.bytes, scratch.data());
    else
        put_coordinates<std::uint64_t>(*chunk.positions, layout.bytes, scratch.data());
    for (std::size_t k = 0; k < layout.offsets.size(); ++k) {
        const std::byte* from = chunk.attributes[k]->data();
        for (std::size_t i = 0; i < chunk.points; ++i)
            std::memcpy(scratch.data() + i * layout.bytes + layout.offsets[k], from + i * layout.sizes[k],
                        layout.sizes[k]);
    }
    return hash_rows(scratch.data(), chunk.points, layout.bytes);
}

}  // namespace pcm
