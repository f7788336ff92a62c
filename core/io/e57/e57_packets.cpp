#include "pcm/io/e57/e57_packets.h"

#include "pcm/io/e57/load_value.h"
#include "pcm/io/file_text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace pcm {
namespace {

constexpr std::size_t section_header_bytes = 32;
// 64-bit values may begin at the last bit of a byte.
constexpr std::size_t bytes_behind = 16;
// Writers balance the streams of a packet; a stream that is ahead of the others has to be kept in memory.
constexpr std::size_t most_waiting_bytes = std::size_t{64} << 20;

std::uint64_t load_bits(const std::byte* bytes, std::uint64_t bit, unsigned count)
{
    const std::byte* from = bytes + bit / 8;
    const unsigned shift = static_cast<unsigned>(bit % 8);
    std::uint64_t value = load<std::uint64_t>(from) >> shift;
    if (shift + count > 64) value |= static_cast<std::uint64_t>(from[8]) << (64 - shift);
    return count == 64 ? value : value & ((std::uint64_t{1} << count) - 1);
}

}  // namespace

E57Packets::E57Packets(E57Pages& pages, const E57Scan& scan, std::string called)
    : pages_(pages), scan_(scan), called_(std::move(called)), streams_(scan.fields.size())
{
    unsigned bits = 0;
    for (const E57Field& field : scan.fields) {
        bits_.push_back(field.bits());
        bits += bits_.back();
    }
    if (scan.records == 0) return;

    const std::uint64_t begin = pages.to_logical(scan.file_offset);
    if (pages.logical_size() - begin < section_header_bytes)
        fail(ErrorCode::truncated, "its points should begin at byte " + std::to_string(scan.file_offset) +
                                       ", the file has " + std::to_string(pages.physical_size()) + " bytes");
    std::array<std::byte, section_header_bytes> header;
    pages.read(header.data(), header.size(), begin);
    if (load<std::uint8_t>(&header[0]) != 1)
        fail(ErrorCode::bad_format, "byte " + std::to_string(scan.file_offset) + ": a section of type " +
                                        std::to_string(load<std::uint8_t>(&header[0])) + ", expected 1, points");
    const auto length = load<std::uint64_t>(&header[8]), offset = load<std::uint64_t>(&header[16]);
    next_packet_ = pages.to_logical(offset);
    if (next_packet_ <= begin || next_packet_ >= pages.logical_size())
        fail(ErrorCode::bad_format, "byte " + std::to_string(scan.file_offset + 16) + ": the packets should begin at " +
                                        std::to_string(offset) + ", expected a byte after this one and inside the " +
                                        "file of " + std::to_string(pages.physical_size()));
    if (length < section_header_bytes || length > pages.logical_size() - begin)
        fail(ErrorCode::truncated, "byte " + std::to_string(scan.file_offset + 8) + ": a section of " +
                                       std::to_string(length) + " bytes, the file has " +
                                       std::to_string(pages.logical_size() - begin) + " bytes of content from there");
    end_ = begin + length;

    // A field with a single possible value takes no bytes; points without any bytes are accepted up to the size of the
    // file.
    const std::uint64_t left = end_ - std::min(end_, next_packet_);
    const std::uint64_t room = bits ? left * 8 / bits : pages.physical_size();
    if (scan.records > room)
        fail(ErrorCode::truncated, std::to_string(scan.records) + " points of " + std::to_string(bits) +
                                       " bits are promised; from byte " + std::to_string(offset) + " there are " +
                                       std::to_string(left) + " bytes for them");
}

void E57Packets::fail(ErrorCode code, const std::string& what) const
{
    throw Error(code, pages_.file().path(), called_ + ": " + what);
}

void E57Packets::append(Stream& stream, std::size_t bytes, std::uint64_t at)
{
    const auto gone = static_cast<std::size_t>(stream.bit / 8);
    if (gone) {
        std::memmove(stream.bytes.data(), stream.bytes.data() + gone, stream.used - gone);
        stream.used -= gone;
        stream.bit %= 8;
    }
    stream.bytes.resize(stream.used + bytes + bytes_behind);
    pages_.read(stream.bytes.data() + stream.used, bytes, at);
    stream.used += bytes;
    std::fill_n(stream.bytes.data() + stream.used, bytes_behind, std::byte{0});
}

void E57Packets::read_packet()
{
    const std::string place = "byte " + std::to_string(E57Pages::to_physical(next_packet_)) + ": ";
    std::array<std::byte, 6> header{};
    if (end_ - std::min(end_, next_packet_) < 4)
        fail(ErrorCode::truncated, place + "the packets end after " + std::to_string(points_) + " of " +
                                       std::to_string(scan_.records) + " points");
    pages_.read(header.data(), 4, next_packet_);
    const auto type = load<std::uint8_t>(&header[0]);
    const std::uint64_t length = load<std::uint16_t>(&header[2]) + std::uint64_t{1};
    if (type > 2)
        fail(ErrorCode::bad_format, place + "a packet of type " + std::to_string(type) + ", expected 0, 1 or 2");
    if (length % 4 || length > end_ - next_packet_)
        fail(ErrorCode::bad_format, place + "a packet of " + std::to_string(length) +
                                        " bytes, expected a multiple of 4 that the section holds");
    const std::uint64_t begin = next_packet_;
    next_packet_ += length;
    if (type != 1) return;  // an index packet or an empty one

    if (length < 6 + 2 * streams_.size())
        fail(ErrorCode::bad_format, place + "a packet of " + std::to_string(length) + " bytes is too short for " +
                                        std::to_string(streams_.size()) + " byte streams");
    pages_.read(header.data() + 4, 2, begin + 4);
    if (load<std::uint16_t>(&header[4]) != streams_.size())
        fail(ErrorCode::bad_format, place + "a packet of " + std::to_string(load<std::uint16_t>(&header[4])) +
                                        " byte streams, the points have " + std::to_string(streams_.size()) +
                                        " fields");
    std::vector<std::uint16_t> sizes(streams_.size());
    pages_.read(sizes.data(), 2 * sizes.size(), begin + 6);
    std::uint64_t at = begin + 6 + 2 * sizes.size();
    std::size_t waiting = 0;
    for (std::size_t i = 0; i < streams_.size(); ++i) {
        if (sizes[i] > next_packet_ - at)
            fail(ErrorCode::bad_format,
                 place + "the byte streams are longer than their packet of " + std::to_string(length) + " bytes");
        // Bytes after the last value of a field are discarded.
        if (bits_[i]) append(streams_[i], sizes[i], at);
        at += sizes[i];
        waiting += streams_[i].used;
    }
    if (waiting > most_waiting_bytes)
        fail(ErrorCode::unsupported, place + "the byte streams of some fields run ahead of others by more than " +
                                         std::to_string(most_waiting_bytes) + " bytes");
}

void E57Packets::prepare(std::size_t count)
{
    for (std::size_t i = 0; i < streams_.size(); ++i) streams_[i].bit += std::uint64_t{bits_[i]} * prepared_;
    prepared_ = 0;
    for (std::size_t i = 0; i < streams_.size(); ++i)
        while (streams_[i].used * 8 - streams_[i].bit < std::uint64_t{bits_[i]} * count) read_packet();
    prepared_ = count;
    points_ += count;
}

void E57Packets::integers(std::size_t field, std::int64_t* to)
{
    const Stream& stream = streams_[field];
    const unsigned bits = bits_[field];
    const std::int64_t min = scan_.fields[field].min;
    if (bits == 0) {
        std::fill_n(to, prepared_, min);
        return;
    }
    // Only this sum can exceed 64 bits.
    const auto room =
        static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) - static_cast<std::uint64_t>(min);
    for (std::size_t i = 0; i < prepared_; ++i) {
        const std::uint64_t raw = load_bits(stream.bytes.data(), stream.bit + std::uint64_t{bits} * i, bits);
        if (raw > room)
            fail(ErrorCode::bad_format, "point " + std::to_string(points_ - prepared_ + i) + ": the field '" +
                                            printable_name(scan_.fields[field].name) + "' is " + std::to_string(raw) +
                                            " above its minimum of " + std::to_string(min) +
                                            ", which does not fit 64 bits");
        to[i] = static_cast<std::int64_t>(static_cast<std::uint64_t>(min) + raw);
    }
}

void E57Packets::floats(std::size_t field, double* to)
{
    // Float streams consist of whole bytes, so the value starts at a byte.
    const std::byte* from = streams_[field].bytes.data() + streams_[field].bit / 8;
    if (scan_.fields[field].kind == E57Field::Kind::f32)
        for (std::size_t i = 0; i < prepared_; ++i) to[i] = static_cast<double>(load<float>(from + 4 * i));
    else
        for (std::size_t i = 0; i < prepared_; ++i) to[i] = load<double>(from + 8 * i);
}

}  // namespace pcm
