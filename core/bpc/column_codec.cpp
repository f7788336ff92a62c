#include "pcm/bpc/column_codec.h"

#include "pcm/bpc/column_loops.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

namespace pcm {
namespace {

// Stream: u8 mode, u8 base_bits, u16 0, u32 bytes of the whole stream, u64 smallest base (or the constant); then,
// unless constant: a (u8 width, u8 shift) pair per block, the bases less the smallest in base_bits each, padded to a
// byte, and the 128 differences of each block in width bits each (16 * width bytes; the last block is padded with
// zeros). Where values are listed: u8 mode, u8 0, u16 values less one, u32 bytes, u64 0; then the values in ascending
// order and the place of each value of the sequence among them, both as streams of the other modes.
enum Mode : std::uint8_t { constant = 0, frame_of_reference = 1, delta = 2, listed = 3 };
constexpr std::size_t stream_header = 16;
constexpr std::size_t most_listed = 256;

int bit_length(std::uint64_t v) { return v ? 64 - __builtin_clzll(v) : 0; }
std::uint64_t low_mask(int bits) { return bits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1; }

template <class Word>
Word unzigzag(Word z)
{
    return static_cast<Word>(z >> 1) ^ static_cast<Word>(Word(0) - (z & 1));
}
// The loops for the processor's SIMD level, chosen once: columns are packed in many places.
template <class Word>
const ColumnLoops<Word>& loops()
{
    static const AllColumnLoops& all = column_loops();
    if constexpr (sizeof(Word) == 4)
        return all.narrow;
    else
        return all.wide;
}

struct BlockShape {
    std::uint64_t base = 0;
    std::uint8_t width = 0;
    std::uint8_t shift = 0;
};

template <class Word>
BlockShape shape_of_reference(const Word* v, std::size_t n)
{
    Word any = 0;
    BlockShape shape;
    shape.base = loops<Word>().reference(v, n, any);
    if (any) {
        shape.shift = static_cast<std::uint8_t>(__builtin_ctzll(any));
        shape.width = static_cast<std::uint8_t>(bit_length(any >> shape.shift));
    }
    return shape;
}

template <class Word>
BlockShape shape_of_delta(const Word* v, std::size_t n)
{
    // zigzag(d >> s) has as many bits as zigzag(d) >> s, so one pass finds width and shift.
    Word any = 0, any_zigzag = 0;
    loops<Word>().differences(v, n, any, any_zigzag);
    BlockShape shape;
    shape.base = v[0];
    if (any) {
        shape.shift = static_cast<std::uint8_t>(__builtin_ctzll(any));
        shape.width = static_cast<std::uint8_t>(bit_length(any_zigzag) - shape.shift);
    }
    return shape;
}

// 128 values of `Width` bits, least significant bit first, are 16 * Width bytes, and eight of them are Width bytes.
// With Width a template parameter all shifts are constants.
template <class Word, int Width>
void pack_block(const Word* values, std::byte* to)
{
    std::array<std::byte, 16 * Width + 8> bytes;
    for (std::size_t group = 0; group < codec_block / 8; ++group) {
        std::byte* at = bytes.data() + group * Width;
        std::uint64_t word = 0;
        int filled = 0;
        for (std::size_t i = 0; i < 8; ++i) {
            const std::uint64_t v = values[group * 8 + i];
            word |= v << filled;
            filled += Width;
            if (filled >= 64) {
                std::memcpy(at, &word, 8);
                at += 8;
                filled -= 64;
                word = filled ? v >> (Width - filled) : 0;
            }
        }
        std::memcpy(at, &word, 8);  // the next group begins within it
    }
    std::memcpy(to, bytes.data(), 16 * Width);
}

template <class Word, int Width>
void unpack_block(const std::byte* from, Word* values)
{
    constexpr std::uint64_t mask = Width >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << Width) - 1;
    for (std::size_t group = 0; group < codec_block / 8; ++group) {
        for (std::size_t i = 0; i < 8; ++i) {
            const std::size_t bit = i * Width;
            const std::byte* at = from + group * Width + (bit >> 3);
            std::uint64_t word;
            std::memcpy(&word, at, 8);
            word >>= bit & 7;
            if constexpr (Width > 57)
                if (Width + (bit & 7) > 64) word |= static_cast<std::uint64_t>(at[8]) << (64 - (bit & 7));
            values[group * 8 + i] = static_cast<Word>(word & mask);
        }
    }
}

template <class Word>
struct BlockCoders {
    static constexpr std::size_t widths = sizeof(Word) * 8 + 1;
    std::array<void (*)(const Word*, std::byte*), widths> pack{};
    std::array<void (*)(const std::byte*, Word*), widths> unpack{};
};

template <class Word, std::size_t... Width>
constexpr BlockCoders<Word> block_coders_of(std::index_sequence<Width...>)
{
    return {{pack_block<Word, static_cast<int>(Width)>...}, {unpack_block<Word, static_cast<int>(Width)>...}};
}

template <class Word>
constexpr BlockCoders<Word> block_coders = block_coders_of<Word>(std::make_index_sequence<BlockCoders<Word>::widths>());

// For the bases: sequences of any length and width.
void pack_bits(const std::vector<std::uint64_t>& values, int width, std::byte* to)
{
    std::size_t bit = 0;
    for (const std::uint64_t v : values)
        for (int done = 0; done < width;) {
            const int free = 8 - static_cast<int>(bit & 7);  // free bits of the current byte
            to[bit >> 3] |= static_cast<std::byte>(v >> done << (bit & 7));
            const int put = std::min(free, width - done);
            done += put;
            bit += static_cast<std::size_t>(put);
        }
}
std::uint64_t bits_at(const std::byte* from, std::size_t bit, int width)
{
    std::uint64_t word;
    std::memcpy(&word, from + (bit >> 3), 8);
    word >>= bit & 7;
    if (const unsigned have = 64 - static_cast<unsigned>(bit & 7); have < static_cast<unsigned>(width))
        word |= static_cast<std::uint64_t>(from[(bit >> 3) + 8]) << have;
    return word & low_mask(width);
}

// The mode that takes fewer bits for a sequence, and the shapes of its blocks.
struct SequenceShape {
    bool use_delta = false;
    std::size_t bits = 0;  // sum of the blocks' widths
    std::vector<BlockShape> blocks;
};

template <class Word>
SequenceShape choose_shapes(const Word* values, std::size_t count)
{
    const std::size_t blocks = (count + codec_block - 1) / codec_block;
    std::vector<BlockShape> reference(blocks), differences(blocks);
    std::size_t reference_bits = 0, delta_bits = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        const Word* v = values + b * codec_block;
        const std::size_t n = std::min(codec_block, count - b * codec_block);
        reference[b] = shape_of_reference(v, n);
        differences[b] = reference[b].width ? shape_of_delta(v, n) : reference[b];
        reference_bits += reference[b].width;
        delta_bits += differences[b].width;
    }
    if (delta_bits < reference_bits) return {true, delta_bits, std::move(differences)};
    return {false, reference_bits, std::move(reference)};
}

Error refused(const char* what, const std::filesystem::path& path)
{
    return Error(ErrorCode::corrupt, path, std::string("packed column: ") + what);
}

struct StreamHeader {
    std::uint8_t mode;
    int base_bits;
    std::uint32_t bytes;
    std::uint64_t low;
};

StreamHeader read_stream_header(const std::byte* data, std::size_t size, int word_bits,
                                const std::filesystem::path& path)
{
    if (size < stream_header) throw refused("shorter than its header", path);
    StreamHeader header;
    header.mode = static_cast<std::uint8_t>(data[0]);
    header.base_bits = static_cast<int>(data[1]);
    std::memcpy(&header.bytes, data + 4, 4);
    std::memcpy(&header.low, data + 8, 8);
    if (header.bytes < stream_header || header.bytes > size) throw refused("its length does not fit the column", path);
    if (header.low > low_mask(word_bits)) throw refused("a value does not fit its type", path);
    if (header.mode == constant) return header;
    if (header.mode != frame_of_reference && header.mode != delta && header.mode != listed)
        throw refused("unknown mode", path);
    if (header.base_bits > word_bits) throw refused("base wider than its type", path);
    return header;
}

// The distinct values of a sequence that has few.
template <class Word>
class ValueList {
public:
    // False where there are more than most_listed.
    bool take(const Word* values, std::size_t count)
    {
        for (std::size_t i = 0; i < count; ++i) {
            Slot& slot = slot_of(values[i]);
            if (slot.used) continue;
            if (sorted_.size() == most_listed) return false;
            slot.used = true;
            slot.value = values[i];
            sorted_.push_back(values[i]);
        }
        std::sort(sorted_.begin(), sorted_.end());
        for (std::size_t place = 0; place < sorted_.size(); ++place)
            slot_of(sorted_[place]).place = static_cast<Word>(place);
        return true;
    }
    const std::vector<Word>& sorted() const { return sorted_; }
    Word place_of(Word value) { return slot_of(value).place; }

private:
    struct Slot {
        Word value = 0, place = 0;
        bool used = false;
    };
    static constexpr int slot_bits = 10;

    // The value's, or the free one where it would be.
    Slot& slot_of(Word value)
    {
        constexpr std::uint64_t odd = 0x9e3779b97f4a7c15;
        std::size_t at = static_cast<std::size_t>(std::uint64_t(value) * odd >> (64 - slot_bits));
        while (slots_[at].used && slots_[at].value != value) at = (at + 1) & (slots_.size() - 1);
        return slots_[at];
    }

    std::array<Slot, std::size_t(1) << slot_bits> slots_;
    std::vector<Word> sorted_;
};

// How a sequence is written in one of the modes that list no values.
struct PlainStream {
    SequenceShape shape;
    std::uint64_t low = 0;
    bool is_constant = false;
    int base_bits = 0;
    std::size_t bytes = 0;
};

template <class Word>
PlainStream plain_stream(const Word* values, std::size_t count)
{
    PlainStream stream;
    stream.shape = choose_shapes(values, count);
    const std::vector<BlockShape>& shapes = stream.shape.blocks;
    std::uint64_t low = shapes[0].base, high = low;
    for (const BlockShape& shape : shapes) {
        low = std::min(low, shape.base);
        high = std::max(high, shape.base);
    }
    stream.low = low;
    stream.is_constant = !stream.shape.use_delta && stream.shape.bits == 0 && low == high;
    stream.base_bits = stream.is_constant ? 0 : bit_length(high - low);
    const std::size_t table =
        stream.is_constant ? 0
                           : shapes.size() * 2 + (shapes.size() * static_cast<std::size_t>(stream.base_bits) + 7) / 8;
    stream.bytes = stream_header + table + stream.shape.bits * (codec_block / 8);
    return stream;
}

template <class Word>
void put(const PlainStream& stream, const Word* values, std::size_t count, std::vector<std::byte>& out)
{
    const std::size_t start = out.size();
    const auto& [use_delta, bits, shapes] = stream.shape;
    const auto [low, is_constant, base_bits, bytes] =
        std::tuple(stream.low, stream.is_constant, stream.base_bits, stream.bytes);
    const std::size_t blocks = shapes.size();
    if (bytes > 0xffffffffu) throw Error(ErrorCode::unsupported, {}, "a column of more than 4 GiB in one chunk");
    out.resize(start + bytes);
    std::byte* to = out.data() + start;
    to[0] = static_cast<std::byte>(is_constant ? constant : use_delta ? delta : frame_of_reference);
    to[1] = static_cast<std::byte>(base_bits);
    to[2] = to[3] = std::byte(0);
    const auto size32 = static_cast<std::uint32_t>(bytes);
    std::memcpy(to + 4, &size32, 4);
    std::memcpy(to + 8, &low, 8);
    to += stream_header;
    if (is_constant) return;
    for (const BlockShape& shape : shapes) {
        *to++ = static_cast<std::byte>(shape.width);
        *to++ = static_cast<std::byte>(shape.shift);
    }
    std::vector<std::uint64_t> bases(blocks);
    for (std::size_t b = 0; b < blocks; ++b) bases[b] = shapes[b].base - low;
    pack_bits(bases, base_bits, to);
    to += (blocks * static_cast<std::size_t>(base_bits) + 7) / 8;
    std::array<Word, codec_block> block{};
    for (std::size_t b = 0; b < blocks; ++b) {
        const BlockShape& shape = shapes[b];
        if (shape.width == 0) continue;
        const Word* v = values + b * codec_block;
        const std::size_t n = std::min(codec_block, count - b * codec_block);
        if (use_delta)
            loops<Word>().put_differences(v, n, shape.shift, block.data());
        else
            loops<Word>().put_reference(v, n, static_cast<Word>(shape.base), shape.shift, block.data());
        std::fill(block.begin() + static_cast<std::ptrdiff_t>(n), block.end(), Word(0));
        block_coders<Word>.pack[shape.width](block.data(), to);
        to += shape.width * (codec_block / 8);
    }
}

// Appends the sequence with its values listed, where they are few and that takes less than `plain`.
template <class Word>
bool put_listed(const PlainStream& plain, const Word* values, std::size_t count, std::vector<std::byte>& out)
{
    // Fewer bits than this for a value are hardly more than a place among many takes.
    constexpr std::size_t least_bits = 9;
    if (plain.shape.bits < least_bits * plain.shape.blocks.size()) return false;
    ValueList<Word> list;
    if (!list.take(values, count)) return false;
    std::vector<Word> places(count);
    for (std::size_t i = 0; i < count; ++i) places[i] = list.place_of(values[i]);
    const std::vector<Word>& sorted = list.sorted();
    const PlainStream of_values = plain_stream(sorted.data(), sorted.size());
    const PlainStream of_places = plain_stream(places.data(), count);
    const std::size_t bytes = stream_header + of_values.bytes + of_places.bytes;
    if (bytes >= plain.bytes) return false;
    const std::size_t start = out.size();
    out.resize(start + stream_header);
    out[start] = static_cast<std::byte>(listed);
    const auto last = static_cast<std::uint16_t>(sorted.size() - 1);
    const auto size32 = static_cast<std::uint32_t>(bytes);
    std::memcpy(out.data() + start + 2, &last, 2);
    std::memcpy(out.data() + start + 4, &size32, 4);
    put(of_values, sorted.data(), sorted.size(), out);
    put(of_places, places.data(), count, out);
    return true;
}

template <class Word>
std::size_t unpack_plain(const std::byte* data, std::size_t size, Word* values, std::size_t count,
                         const std::filesystem::path& path)
{
    constexpr int word_bits = sizeof(Word) * 8;
    const auto refuse = [&](const char* what) { return refused(what, path); };
    const auto [mode, base_bits, bytes, low] = read_stream_header(data, size, word_bits, path);
    if (mode == listed) throw refuse("a list within a list");
    if (mode == constant) {
        std::fill(values, values + count, static_cast<Word>(low));
        return bytes;
    }
    const std::size_t blocks = (count + codec_block - 1) / codec_block;
    const std::size_t base_bytes = (blocks * static_cast<std::size_t>(base_bits) + 7) / 8;
    std::size_t left = bytes - stream_header;
    if (left < blocks * 2 + base_bytes) throw refuse("shorter than its block table");
    const std::byte* table = data + stream_header;
    const std::byte* bases = table + blocks * 2;
    const std::byte* payload = bases + base_bytes;
    left -= blocks * 2 + base_bytes;
    std::array<Word, codec_block> block;
    for (std::size_t b = 0; b < blocks; ++b) {
        const int width = static_cast<int>(table[2 * b]);
        const int shift = static_cast<int>(table[2 * b + 1]);
        if (width > word_bits || shift >= word_bits) throw refuse("block wider than its type");
        const std::size_t block_bytes = static_cast<std::size_t>(width) * (codec_block / 8);
        if (block_bytes > left) throw refuse("shorter than its blocks");
        const auto base = static_cast<Word>(
            low + (base_bits ? bits_at(bases, b * static_cast<std::size_t>(base_bits), base_bits) : 0));
        Word* v = values + b * codec_block;
        const std::size_t n = std::min(codec_block, count - b * codec_block);
        if (width == 0) {
            std::fill(v, v + n, base);
            continue;
        }
        Word* target = n == codec_block ? v : block.data();
        block_coders<Word>.unpack[static_cast<std::size_t>(width)](payload, target);
        if (mode == delta) {
            Word sum = base;
            for (std::size_t i = 0; i < n; ++i)
                v[i] = sum = static_cast<Word>(sum + static_cast<Word>(unzigzag(target[i]) << shift));
        } else {
            for (std::size_t i = 0; i < n; ++i) v[i] = static_cast<Word>(base + static_cast<Word>(target[i] << shift));
        }
        payload += block_bytes;
        left -= block_bytes;
    }
    if (left != 0) throw refuse("longer than its blocks");
    return bytes;
}

}  // namespace

template <class Word>
void pack(const Word* values, std::size_t count, std::vector<std::byte>& out)
{
    const PlainStream plain = plain_stream(values, count);
    if (!put_listed(plain, values, count, out)) put(plain, values, count, out);
}

template <class Word>
std::size_t unpack(const std::byte* data, std::size_t size, Word* values, std::size_t count,
                   const std::filesystem::path& path)
{
    const StreamHeader header = read_stream_header(data, size, sizeof(Word) * 8, path);
    if (header.mode != listed) return unpack_plain(data, size, values, count, path);
    std::uint16_t last = 0;
    std::memcpy(&last, data + 2, 2);
    const std::size_t number = std::size_t(last) + 1;
    if (number > most_listed) throw refused("too many listed values", path);
    std::array<Word, most_listed> list;
    std::size_t at = stream_header;
    at += unpack_plain(data + at, header.bytes - at, list.data(), number, path);
    at += unpack_plain(data + at, header.bytes - at, values, count, path);
    if (at != header.bytes) throw refused("longer than its lists", path);
    for (std::size_t i = 1; i < number; ++i)
        if (list[i] <= list[i - 1]) throw refused("listed values out of order", path);
    Word largest = 0;
    for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, values[i]);
    if (largest >= number) throw refused("a place beyond its list", path);
    for (std::size_t i = 0; i < count; ++i) values[i] = list[static_cast<std::size_t>(values[i])];
    return header.bytes;
}

template void pack(const std::uint32_t*, std::size_t, std::vector<std::byte>&);
template void pack(const std::uint64_t*, std::size_t, std::vector<std::byte>&);
template std::size_t unpack(const std::byte*, std::size_t, std::uint32_t*, std::size_t, const std::filesystem::path&);
template std::size_t unpack(const std::byte*, std::size_t, std::uint64_t*, std::size_t, const std::filesystem::path&);

}  // namespace pcm
