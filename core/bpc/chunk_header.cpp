#include "pcm/bpc/chunk_header.h"

#include "pcm/bpc/attribute_bytes.h"
#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk.h"
#include "pcm/bpc/chunk_bytes.h"
#include "pcm/bpc/column_codec.h"
#include "pcm/bpc/layout.h"
#include "pcm/bpc/scalar_words.h"
#include "pcm/bpc/segments.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace pcm {

namespace {

// Whether `bytes` can be `sequences` packed sequences of `points` words each.
bool can_be_packed(std::uint64_t bytes, std::uint64_t sequences, std::uint64_t points, std::uint64_t word_bytes)
{
    const std::uint64_t blocks = (points + codec_block - 1) / codec_block;
    const std::uint64_t least = 16, most = 16 + blocks * (2 + word_bytes + codec_block * word_bytes);
    return bytes / least >= sequences && (bytes / most < sequences || bytes == sequences * most);
}

bool fits(const Box3i& box, bool wide)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (box.min[a] > box.max[a] ||
            (!wide && static_cast<std::uint64_t>(box.max[a]) - static_cast<std::uint64_t>(box.min[a]) >
                          std::numeric_limits<std::uint32_t>::max()))
            return false;
    return true;
}

void check_decoded_size(const BpcHeader& header, const std::filesystem::path& path)
{
    const std::uint64_t bytes = bpc_layout::decoded_bytes(header.points, header.wide, header.schema);
    if (bytes > bpc_layout::most_decoded_bytes)
        throw Error(ErrorCode::corrupt, path,
                    "a chunk of " + std::to_string(header.points) + " points; decoded they would take " +
                        std::to_string(bytes) + " bytes, at most " + std::to_string(bpc_layout::most_decoded_bytes) +
                        " are possible");
}

// Reads a header after its first 144 bytes.
class HeaderReader {
public:
    HeaderReader(ByteReader& in, BpcHeader& header, const std::filesystem::path& path)
        : in_(in), header_(header), path_(path)
    {
    }

    // Versions 1 and 2.
    void read_whole_columns(std::uint32_t attributes)
    {
        header_.segments = {{0, header_.points, 0, header_.box}};
        header_.positions = get_whole(3, header_.wide ? 8 : 4);
        for (std::uint32_t i = 0; i < attributes; ++i) {
            const Attribute attribute = get_attribute(in_, header_.schema, path_);
            header_.attributes.push_back(get_whole(attribute.components, word_bytes_of(attribute.type)));
        }
    }

    // Version 3, after its path.
    void read_segments(std::uint32_t attributes, bool sizes, const NodePath& path)
    {
        read_identity(path);
        read_boxes();
        std::uint64_t end = header_.header_bytes;  // columns follow one another without gaps
        header_.positions = get_pieces(3, header_.wide ? 8 : 4, end);
        for (std::uint32_t i = 0; i < attributes; ++i) {
            const Attribute attribute = get_attribute(in_, header_.schema, path_);
            header_.attributes.push_back(get_column(attribute, end));
        }
        if (sizes) header_.sizes = get_column(attribute_of_sizes(), end);
        if (end != header_.total_bytes) refuse("a chunk's columns do not end where the chunk ends");
        if (in_.position() + 8 != header_.header_bytes) refuse("a chunk's header has another length than it states");
    }

private:
    [[noreturn]] void refuse(const std::string& what) const { throw Error(ErrorCode::corrupt, path_, what); }

    BpcColumn get_whole(std::uint64_t sequences, std::uint64_t word_bytes)
    {
        BpcColumn column;
        column.offset = in_.get<std::uint64_t>();
        column.bytes = in_.get<std::uint64_t>();
        const auto sum = in_.get<std::uint64_t>();
        if (column.offset < header_.header_bytes || column.offset > header_.total_bytes ||
            column.bytes > header_.total_bytes - column.offset)
            refuse("a column lies outside its chunk");
        if (!can_be_packed(column.bytes, sequences, header_.points, word_bytes))
            refuse("a column of " + std::to_string(column.bytes) + " bytes cannot hold the chunk's " +
                   std::to_string(header_.points) + " points");
        column.pieces = {{column.offset, column.bytes, sum}};
        return column;
    }

    void read_identity(const NodePath& path)
    {
        ChunkIdentity identity;
        identity.path = path;
        identity.part = in_.get<std::uint32_t>();
        identity.generation = in_.get<std::uint32_t>();
        identity.spacing = in_.get<double>();
        identity.first_level = in_.get<std::uint16_t>();
        const auto levels = in_.get<std::uint16_t>();
        if (levels > 256) refuse("a chunk's header is invalid");
        std::uint64_t points = 0;
        for (std::uint16_t k = 0; k < levels; ++k) {
            identity.level_points.push_back(in_.get<std::uint32_t>());
            points += identity.level_points.back();
        }
        if (points != header_.points) refuse("the numbers of points of a chunk's levels do not add up");
        if (const char* wrong = bpc_layout::wrong_with(identity)) refuse(std::string("a chunk has ") + wrong);
        header_.identity = std::move(identity);
    }

    void read_boxes()
    {
        const std::uint64_t segments = count_segments(*header_.identity, header_.points);
        if (segments > in_.left() / (header_.wide ? 48u : 24u))
            refuse("a chunk's header is too short for its segments");
        header_.segments = segments_of(*header_.identity, header_.points);
        const Box3i& whole = header_.box;
        Box3i all;
        for (BpcSegment& segment : header_.segments) {
            for (Vec3i* corner : {&segment.box.min, &segment.box.max})
                for (std::size_t a = 0; a < 3; ++a) {
                    const std::uint64_t relative = header_.wide ? in_.get<std::uint64_t>() : in_.get<std::uint32_t>();
                    if (relative > static_cast<std::uint64_t>(whole.max[a]) - static_cast<std::uint64_t>(whole.min[a]))
                        refuse("a segment's box lies outside its chunk's");
                    (*corner)[a] = static_cast<std::int64_t>(static_cast<std::uint64_t>(whole.min[a]) + relative);
                }
            if (segment.box.empty()) refuse("a segment's box is empty");
            all.extend(segment.box);
        }
        if (!(all == whole)) refuse("a chunk's box is not the box of its segments");
    }

    BpcColumn get_column(const Attribute& attribute, std::uint64_t& end)
    {
        const auto mode = in_.get<std::uint8_t>();
        if (mode == bpc_layout::constant && header_.points > 0) return get_constant(attribute, end);
        if (mode == bpc_layout::in_segments)
            return get_pieces(attribute.components, word_bytes_of(attribute.type), end);
        refuse("a column has an unknown mode");
    }

    BpcColumn get_pieces(std::uint64_t sequences, std::uint64_t word_bytes, std::uint64_t& end)
    {
        BpcColumn column;
        column.offset = end;
        if (header_.segments.size() > in_.left() / 12) refuse("a chunk's header is too short for its segments");
        column.pieces.resize(header_.segments.size());
        for (std::size_t s = 0; s < column.pieces.size(); ++s) {
            BpcPiece& piece = column.pieces[s];
            piece.offset = end;
            piece.bytes = in_.get<std::uint32_t>();
            piece.checksum = in_.get<std::uint64_t>();
            if (!can_be_packed(piece.bytes, sequences, header_.segments[s].count, word_bytes))
                refuse("a segment of " + std::to_string(piece.bytes) + " bytes cannot hold its " +
                       std::to_string(header_.segments[s].count) + " points");
            end += piece.bytes;
        }
        column.bytes = end - column.offset;
        return column;
    }

    BpcColumn get_constant(const Attribute& attribute, std::uint64_t end)
    {
        BpcColumn column;
        column.offset = end;
        if (attribute.components > in_.left() / 8) refuse("a chunk's header is too short for its constants");
        column.constant.resize(attribute.components);
        const std::size_t bits = size_of(attribute.type) * 8;
        for (std::uint64_t& word : column.constant) {
            word = in_.get<std::uint64_t>();
            if (bits < 64 && word >> bits) refuse("a constant does not fit its type");
        }
        return column;
    }

    ByteReader& in_;
    BpcHeader& header_;
    const std::filesystem::path& path_;
};

}  // namespace

BpcHeader decode_header(const std::byte* data, std::size_t size, const std::filesystem::path& path)
{
    using namespace bpc_layout;
    if (size < fixed_header) throw Error(ErrorCode::corrupt, path, "a chunk is shorter than its header");
    if (std::memcmp(data, magic, 4) != 0) throw Error(ErrorCode::corrupt, path, "no chunk begins here");
    std::uint16_t version;
    std::memcpy(&version, data + 4, 2);
    if (version != version_on_grid && version != version_of_doubles && version != version_of_trees)
        throw Error(ErrorCode::unsupported, path,
                    "chunk format version " + std::to_string(version) + ", this program reads versions 1 to 3");
    BpcHeader header;
    std::memcpy(&header.header_bytes, data + header_bytes_at, 4);
    std::memcpy(&header.total_bytes, data + total_bytes_at, 8);
    // The smallest header has a checksum behind its fixed part.
    if (header.header_bytes < fixed_header + 8 || header.header_bytes > size ||
        header.header_bytes > header.total_bytes)
        throw Error(ErrorCode::corrupt, path, "a chunk's header length is impossible");
    std::uint64_t stored;
    std::memcpy(&stored, data + header.header_bytes - 8, 8);
    if (stored != checksum(data, header.header_bytes - 8))
        throw Error(ErrorCode::corrupt, path, "the checksum of a chunk's header does not match");
    // The bytes are as they were written; the following checks guard against a faulty writer.
    ByteReader in(data, header.header_bytes - 8, path);
    in.get_bytes(6);
    NodePath node;
    node.depth = in.get<std::uint16_t>();
    for (std::uint64_t& bits : node.bits) bits = in.get<std::uint64_t>();
    in.get_bytes(4);
    header.points = in.get<std::uint32_t>();
    in.get_bytes(8);
    if (version == version_of_doubles) {
        Vec3d divisor, shift;
        for (double& d : divisor) d = in.get<double>();
        for (double& s : shift) s = in.get<double>();
        header.doubles = DoubleCodes::checked(divisor, shift);
        if (!header.doubles) throw Error(ErrorCode::corrupt, path, "a chunk's coding of doubles is invalid");
    } else {
        for (double& s : header.grid.scale) s = in.get<double>();
        for (double& o : header.grid.offset) o = in.get<double>();
    }
    for (std::int64_t& v : header.box.min) v = in.get<std::int64_t>();
    for (std::int64_t& v : header.box.max) v = in.get<std::int64_t>();
    const auto has = in.get<std::uint32_t>();
    const auto attributes = in.get<std::uint32_t>();
    const bool of_tree = version == version_of_trees;
    header.wide = of_tree ? (has & has_wide_positions) != 0 : has != 0;
    const bool tombstone = of_tree && header.points == 0;
    if (attributes > max_attributes || (header.points == 0 && !tombstone) ||
        (of_tree && (has & ~(has_wide_positions | has_sizes))))
        throw Error(ErrorCode::corrupt, path, "a chunk's header is invalid");
    if (tombstone ? header.wide || !(header.box == Box3i()) : !fits(header.box, header.wide))
        throw Error(ErrorCode::corrupt, path, "a chunk's box is invalid");
    HeaderReader rest(in, header, path);
    if (of_tree)
        rest.read_segments(attributes, (has & has_sizes) != 0, node);
    else
        rest.read_whole_columns(attributes);
    if (of_tree) check_decoded_size(header, path);
    return header;
}

BpcHeader read_header(const ByteSource& file, std::uint64_t offset, std::uint64_t available)
{
    try {
        const ChunkBytes bytes(file, offset, available, 4096);
        BpcHeader header = decode_header(bytes.beginning(), static_cast<std::size_t>(bytes.beginning_size()), {});
        if (header.total_bytes > available)
            throw Error(ErrorCode::truncated, {},
                        "its header states " + std::to_string(header.total_bytes) + " bytes; " +
                            std::to_string(available) + " are left");
        return header;
    } catch (const Error& error) {
        rethrow_naming(error, file, offset);
    }
}

}  // namespace pcm
