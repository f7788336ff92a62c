#include "pcm/build/bins/row_packing.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

namespace pcm {
namespace {

constexpr std::size_t block_rows = RowPacking::block_rows;
using Values = std::array<std::uint64_t, block_rows>;

std::uint64_t low_mask(int bits) { return bits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1; }

// `count` values of `bits` bits each, least significant bit first; whole words of 64 bits.
std::size_t packed_bytes(std::size_t count, int bits) { return (count * static_cast<std::size_t>(bits) + 63) / 64 * 8; }

std::byte* put_bits(const Values& values, std::size_t count, int bits, std::byte* to)
{
    std::uint64_t word = 0;
    int filled = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t v = values[i];
        word |= v << filled;
        filled += bits;
        if (filled >= 64) {
            std::memcpy(to, &word, 8);
            to += 8;
            filled -= 64;
            word = filled ? v >> (bits - filled) : 0;
        }
    }
    if (filled) {
        std::memcpy(to, &word, 8);
        to += 8;
    }
    return to;
}

void get_bits(const std::byte* from, std::size_t count, int bits, Values& values)
{
    const std::uint64_t mask = low_mask(bits);
    std::uint64_t word = 0;
    int have = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (have >= bits) {
            values[i] = word & mask;
            word = bits < 64 ? word >> bits : 0;
            have -= bits;
            continue;
        }
        std::uint64_t next;
        std::memcpy(&next, from, 8);
        from += 8;
        values[i] = (word | next << have) & mask;  // have < bits <= 64
        const int used = bits - have;
        word = used < 64 ? next >> used : 0;
        have = 64 - used;
    }
}

template <std::size_t Bytes, class RowAt>
void load_word(const RowAt& row_at, std::size_t count, std::size_t offset, Values& values)
{
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = 0;
        std::memcpy(&values[i], row_at(i) + offset, Bytes);
    }
}

template <std::size_t Bytes>
void store_word(const Values& values, std::size_t count, std::byte* to, std::size_t stride)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride, &values[i], Bytes);
}

template <class F>
void with_bytes(std::size_t bytes, F&& f)
{
    switch (bytes) {
        case 1:
            return f(std::integral_constant<std::size_t, 1>());
        case 2:
            return f(std::integral_constant<std::size_t, 2>());
        case 3:
            return f(std::integral_constant<std::size_t, 3>());
        case 4:
            return f(std::integral_constant<std::size_t, 4>());
        case 5:
            return f(std::integral_constant<std::size_t, 5>());
        case 6:
            return f(std::integral_constant<std::size_t, 6>());
        case 7:
            return f(std::integral_constant<std::size_t, 7>());
        default:
            return f(std::integral_constant<std::size_t, 8>());
    }
}

}  // namespace

RowPacking::RowPacking(const RowLayout& layout, const Schema& schema, bool coordinates, bool signed_coordinates)
    : row_bytes_(layout.bytes), loops_(&packing_loops())
{
    if (coordinates)
        for (std::size_t a = 0; a < 3; ++a)
            add(a * layout.coordinate_bytes, layout.coordinate_bytes, signed_coordinates);
    for (std::size_t k = 0; k < schema.size(); ++k) {
        const ScalarType type = schema[k].type;
        const std::size_t size = size_of(type);
        const bool is_signed =
            type == ScalarType::i8 || type == ScalarType::i16 || type == ScalarType::i32 || type == ScalarType::i64;
        for (std::size_t c = 0; c < schema[k].components; ++c) add(layout.offsets[k] + c * size, size, is_signed);
    }
}

void RowPacking::add(std::size_t offset, std::size_t bytes, bool is_signed)
{
    if (words_.empty() || words_.back().bytes + bytes > 8) {
        words_.emplace_back();
        words_.back().offset = offset;
        header_bytes_ += 8;
    }
    Word& word = words_.back();
    const int shift = static_cast<int>(word.bytes) * 8, bits = static_cast<int>(bytes) * 8;
    word.fields.push_back({shift, bits});
    word.bytes += bytes;
    if (is_signed) word.sign |= std::uint64_t(1) << (shift + bits - 1);
    header_bytes_ += 2;
}

template <class RowAt>
void RowPacking::pack_block(const RowAt& row_at, std::size_t count, std::vector<std::byte>& out) const
{
    std::size_t at = out.size();
    out.resize(at + header_bytes_ + words_.size() * block_rows * 8);
    std::byte* header = out.data() + at;
    std::byte* to = header + header_bytes_;
    Values values, group;
    int group_bits = 0;
    std::array<Part, 8> parts;
    for (const Word& word : words_) {
        with_bytes(word.bytes,
                   [&](auto bytes) { load_word<decltype(bytes)::value>(row_at, count, word.offset, values); });
        const std::uint64_t first = values[0];
        std::uint64_t varies = loops_->differing(values.data(), count, first);
        std::uint64_t base = first ^ word.sign;
        if (varies) {
            for (const Field& field : word.fields) {
                const std::uint64_t mask = low_mask(field.bits);
                if (!(varies >> field.shift & mask)) continue;
                const std::uint64_t low = loops_->least(values.data(), count, word.sign, field.shift, mask);
                base = (base & ~(mask << field.shift)) | low << field.shift;
            }
            varies = loops_->subtract(values.data(), count, word.sign, base);  // no field borrows from the next
        }
        std::memcpy(header, &base, 8);
        header += 8;
        std::size_t used = 0;
        int bits = 0;
        for (const Field& field : word.fields) {
            const std::uint64_t v = varies >> field.shift & low_mask(field.bits);
            const int from = v ? __builtin_ctzll(v) : 0;
            const int length = v ? 64 - __builtin_clzll(v) - from : 0;
            *header++ = static_cast<std::byte>(from);
            *header++ = static_cast<std::byte>(length);
            if (length) parts[used++] = {field.shift + from, length, bits};
            bits += length;
        }
        if (bits == 0) continue;
        if (group_bits + bits > 64) {
            to = put_bits(group, count, group_bits, to);
            group_bits = 0;
        }
        if (group_bits == 0) group.fill(0);
        for (std::size_t p = 0; p < used; ++p) {
            loops_->move_bits(values.data(), count, parts[p].from, low_mask(parts[p].length), group_bits + parts[p].to,
                              group.data());
        }
        group_bits += bits;
    }
    if (group_bits) to = put_bits(group, count, group_bits, to);
    out.resize(static_cast<std::size_t>(to - out.data()));
}

void RowPacking::pack(const std::byte* rows, std::size_t count, std::vector<std::byte>& out) const
{
    for (std::size_t from = 0; from < count; from += block_rows) {
        const std::byte* first = rows + from * row_bytes_;
        pack_block([&](std::size_t i) { return first + i * row_bytes_; }, std::min(block_rows, count - from), out);
    }
}

void RowPacking::pack(const std::byte* rows, const std::uint32_t* order, std::size_t count,
                      std::vector<std::byte>& out) const
{
    // Consecutive rows of the order are far apart in memory: each is fetched once, for all its words.
    std::vector<std::byte> block(block_rows * row_bytes_);
    for (std::size_t from = 0; from < count; from += block_rows) {
        const std::size_t n = std::min(block_rows, count - from);
        gather_rows(rows, order + from, n, row_bytes_, block.data());
        pack_block([&](std::size_t i) { return block.data() + i * row_bytes_; }, n, out);
    }
}

const std::byte* RowPacking::unpack_block(const std::byte* data, const std::byte* end, std::byte* rows,
                                          std::size_t count, const std::filesystem::path& path) const
{
    const auto refuse = [&]() -> Error { return Error(ErrorCode::corrupt, path, "packed rows are invalid"); };
    if (static_cast<std::size_t>(end - data) < header_bytes_) throw refuse();
    const std::byte* header = data;
    data += header_bytes_;

    // First the shape of all words, which decides which of them share a group.
    struct Shape {
        std::uint64_t base;
        std::size_t parts, first_part;
        int bits;
    };
    std::vector<Shape> shapes;
    std::vector<Part> parts;
    shapes.reserve(words_.size());
    for (const Word& word : words_) {
        Shape shape{0, 0, parts.size(), 0};
        std::memcpy(&shape.base, header, 8);
        header += 8;
        for (const Field& field : word.fields) {
            const int from = static_cast<int>(*header++), length = static_cast<int>(*header++);
            if (from + length > field.bits) throw refuse();
            if (length) parts.push_back({field.shift + from, length, shape.bits});
            shape.bits += length;
        }
        shape.parts = parts.size() - shape.first_part;
        shapes.push_back(shape);
    }
    Values values, group;
    for (std::size_t w = 0; w < words_.size();) {
        std::size_t last = w;
        int group_bits = 0;
        while (last < words_.size() && group_bits + shapes[last].bits <= 64) group_bits += shapes[last++].bits;
        if (group_bits) {
            const std::size_t bytes = packed_bytes(count, group_bits);
            if (static_cast<std::size_t>(end - data) < bytes) throw refuse();
            get_bits(data, count, group_bits, group);
            data += bytes;
        }
        int place = 0;
        for (; w < last; ++w) {
            const Word& word = words_[w];
            const Shape& shape = shapes[w];
            if (shape.bits == 0) {
                std::fill(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), shape.base ^ word.sign);
            } else {
                values.fill(0);
                for (std::size_t p = shape.first_part; p < shape.first_part + shape.parts; ++p) {
                    loops_->move_bits(group.data(), count, place + parts[p].to, low_mask(parts[p].length),
                                      parts[p].from, values.data());
                }
                loops_->add(values.data(), count, shape.base, word.sign);
                place += shape.bits;
            }
            with_bytes(word.bytes, [&](auto bytes) {
                store_word<decltype(bytes)::value>(values, count, rows + word.offset, row_bytes_);
            });
        }
    }
    return data;
}

void RowPacking::unpack(const std::byte* data, std::size_t size, std::byte* rows, std::size_t count,
                        const std::filesystem::path& path) const
{
    const std::byte* end = data + size;
    for (std::size_t from = 0; from < count; from += block_rows)
        data = unpack_block(data, end, rows + from * row_bytes_, std::min(block_rows, count - from), path);
    if (data != end) throw Error(ErrorCode::corrupt, path, "packed rows are followed by other bytes");
}

}  // namespace pcm
