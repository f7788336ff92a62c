#include "pcm/bpc/chunk_encoder.h"

#include "pcm/bpc/attribute_bytes.h"
#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/bpc/column_codec.h"
#include "pcm/bpc/layout.h"
#include "pcm/bpc/scalar_words.h"
#include "pcm/bpc/segments.h"
#include "pcm/cloud/with_type.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <limits>

namespace pcm {
namespace {

// How the integers of a chunk become coordinates, as stored in its header.
struct Coding {
    std::uint16_t version;
    Vec3d first, second;  // scale and offset, or divisor and shift
};

template <class Word>
void extend(Box3i& box, std::size_t axis, std::int64_t origin, const Word* relative, std::size_t count)
{
    Word low = relative[0], high = low;
    for (std::size_t i = 1; i < count; ++i) {
        low = std::min(low, relative[i]);
        high = std::max(high, relative[i]);
    }
    const auto grid = [&](Word v) { return static_cast<std::int64_t>(static_cast<std::uint64_t>(origin) + v); };
    box.min[axis] = std::min(box.min[axis], grid(low));
    box.max[axis] = std::max(box.max[axis], grid(high));
}

template <class T>
void pack_scalars(const Column& column, std::size_t first, std::size_t count, std::vector<WordOf<T>>& words,
                  std::vector<std::byte>& out)
{
    words.resize(count);
    const std::size_t n = column.components();
    const T* values = column.as<T>() + first * n;
    for (std::size_t c = 0; c < n; ++c) {
        for (std::size_t i = 0; i < count; ++i) words[i] = to_word(values[i * n + c]);
        pack(words.data(), count, out);
    }
}

template <class T>
std::vector<std::uint64_t> constant_of(const Column& column)
{
    const std::size_t n = column.components();
    const T* values = column.as<T>();
    const std::size_t scalars = column.size() * n;
    // Words are compared: NaN equals itself, and 0 differs from -0.
    for (std::size_t i = n; i < scalars; ++i)
        if (to_word(values[i]) != to_word(values[i - n])) return {};
    std::vector<std::uint64_t> words(n);
    for (std::size_t c = 0; c < n; ++c) words[c] = to_word(values[c]);
    return words;
}

// The payload of a chunk and the place of each piece, relative to the payload's start.
class Payload {
public:
    explicit Payload(std::size_t expected_bytes) { bytes.reserve(expected_bytes); }

    void add_positions(const ChunkPositions& positions, const std::vector<BpcSegment>& segments)
    {
        begin();
        for (const BpcSegment& segment : segments) {
            const std::size_t start = bytes.size();
            for (std::size_t a = 0; a < 3; ++a) {
                if (positions.wide)
                    pack(positions.wide_xyz[a].data() + segment.first, segment.count, bytes);
                else
                    pack(positions.narrow_xyz[a].data() + segment.first, segment.count, bytes);
            }
            end_piece(start);
        }
    }
    void add(const Column& column, const std::vector<BpcSegment>& segments, bool may_be_constant)
    {
        begin();
        with_type(column.type(), [&](auto scalar) {
            using T = decltype(scalar);
            if (may_be_constant) columns.back().constant = constant_of<T>(column);
            if (!columns.back().constant.empty()) return 0;
            std::vector<WordOf<T>> words;
            for (const BpcSegment& segment : segments) {
                const std::size_t start = bytes.size();
                pack_scalars<T>(column, segment.first, segment.count, words, bytes);
                end_piece(start);
            }
            return 0;
        });
    }

    std::vector<std::byte> bytes;
    std::vector<BpcColumn> columns;

private:
    void begin()
    {
        columns.emplace_back();
        columns.back().offset = bytes.size();
    }
    void end_piece(std::size_t start)
    {
        const std::size_t size = bytes.size() - start;
        columns.back().pieces.push_back({start, size, checksum(bytes.data() + start, size)});
        columns.back().bytes += size;
    }
};

void put_pieces(ByteWriter& out, const BpcColumn& column)
{
    for (const BpcPiece& piece : column.pieces) {
        if (piece.bytes > std::numeric_limits<std::uint32_t>::max())
            throw Error(ErrorCode::unsupported, {}, "a segment of more than 4 GiB");
        out.put(static_cast<std::uint32_t>(piece.bytes));
        out.put(piece.checksum);
    }
}

// A column of a chunk of a tree.
void put_column(ByteWriter& out, const BpcColumn& column)
{
    out.put(column.constant.empty() ? bpc_layout::in_segments : bpc_layout::constant);
    for (const std::uint64_t word : column.constant) out.put(word);
    put_pieces(out, column);
}

// The header of a chunk up to its columns. `has`: bits of bpc_layout.
ByteWriter put_head(const Coding& coding, std::uint32_t points, const ChunkIdentity* identity, const Box3i& box,
                    std::uint32_t has, const Schema& schema)
{
    const NodePath path = identity ? identity->path : NodePath();
    ByteWriter out;
    out.put_bytes(bpc_layout::magic, 4);
    out.put(coding.version);
    out.put(path.depth);
    out.put(path.bits[0]);
    out.put(path.bits[1]);
    out.put(std::uint32_t(0));  // header bytes, in finish()
    out.put(points);
    out.put(std::uint64_t(0));  // total bytes, in finish()
    for (const double v : coding.first) out.put(v);
    for (const double v : coding.second) out.put(v);
    for (const std::int64_t v : box.min) out.put(v);
    for (const std::int64_t v : box.max) out.put(v);
    out.put(has);
    out.put(static_cast<std::uint32_t>(schema.size()));
    return out;
}

std::vector<std::byte> finish(ByteWriter& out, const std::vector<std::byte>& payload)
{
    const std::size_t header_bytes = out.size() + 8;
    if (header_bytes > bpc_layout::most_header_bytes)
        throw Error(ErrorCode::unsupported, {}, "a chunk's header is too long");
    out.set(bpc_layout::header_bytes_at, static_cast<std::uint32_t>(header_bytes));
    out.set(bpc_layout::total_bytes_at, static_cast<std::uint64_t>(header_bytes + payload.size()));
    out.put(checksum(out.bytes().data(), out.size()));
    std::vector<std::byte> bytes = std::move(out.bytes());
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    return bytes;
}

void check(const Chunk& chunk, const Schema& schema)
{
    if (chunk.points == 0 || !chunk.positions || chunk.positions->size() != chunk.points ||
        chunk.attributes.size() != schema.size())
        throw Error(ErrorCode::invalid_argument, {}, "a chunk to encode lacks points or columns");
    if (bpc_layout::decoded_bytes(chunk.points, chunk.positions->wide, schema) > bpc_layout::most_decoded_bytes)
        throw Error(ErrorCode::unsupported, {},
                    "a chunk of " + std::to_string(chunk.points) + " points takes more than " +
                        std::to_string(bpc_layout::most_decoded_bytes) + " bytes",
                    "chunks of fewer points are possible, but points at one and the same place share a chunk");
    for (std::size_t i = 0; i < schema.size(); ++i) {
        const Column* column = chunk.attributes[i].get();
        if (!column || column->size() != chunk.points || column->type() != schema[i].type ||
            column->components() != schema[i].components)
            throw Error(ErrorCode::invalid_argument, {}, "a chunk to encode lacks attribute '" + schema[i].name + "'");
    }
    if (chunk.sizes && (chunk.sizes->size() != chunk.points || chunk.sizes->type() != attribute_of_sizes().type))
        throw Error(ErrorCode::invalid_argument, {}, "a chunk to encode has sizes of other points");
}

// Gives the segments their boxes.
void find_boxes(const ChunkPositions& positions, std::vector<BpcSegment>& segments)
{
    for (BpcSegment& segment : segments)
        for (std::size_t a = 0; a < 3; ++a) {
            if (positions.wide)
                extend(segment.box, a, positions.origin[a], positions.wide_xyz[a].data() + segment.first,
                       segment.count);
            else
                extend(segment.box, a, positions.origin[a], positions.narrow_xyz[a].data() + segment.first,
                       segment.count);
        }
}

// Versions 1 and 2: the whole chunk is one segment.
std::vector<std::byte> encode(const Chunk& chunk, const Schema& schema, const Coding& coding)
{
    check(chunk, schema);
    std::vector<BpcSegment> segments(1);
    segments[0].count = chunk.points;
    find_boxes(*chunk.positions, segments);
    Box3i box = segments[0].box;
    box.min = chunk.positions->origin;

    Payload payload(static_cast<std::size_t>(chunk.points) * 10);
    payload.add_positions(*chunk.positions, segments);
    for (const auto& column : chunk.attributes) payload.add(*column, segments, false);

    ByteWriter out = put_head(coding, chunk.points, nullptr, box, chunk.positions->wide ? 1 : 0, schema);
    // The columns' offsets depend on the header's length: they are filled in when it is known.
    std::vector<std::size_t> places;
    const auto put_column = [&](const BpcColumn& column) {
        places.push_back(out.size());
        out.put(column.offset);
        out.put(column.bytes);
        out.put(column.pieces[0].checksum);
    };
    put_column(payload.columns[0]);
    for (std::size_t i = 0; i < schema.size(); ++i) {
        put_attribute(out, schema[i]);
        put_column(payload.columns[1 + i]);
    }
    const std::size_t header_bytes = out.size() + 8;
    for (std::size_t i = 0; i < places.size(); ++i) out.set(places[i], payload.columns[i].offset + header_bytes);
    return finish(out, payload.bytes);
}

}  // namespace

std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid)
{
    return encode(chunk, schema, {bpc_layout::version_on_grid, grid.scale, grid.offset});
}

std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const DoubleCodes& doubles)
{
    const Vec3d shift{double(doubles.shift[0]), double(doubles.shift[1]), double(doubles.shift[2])};
    return encode(chunk, schema, {bpc_layout::version_of_doubles, doubles.divisor, shift});
}

std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid,
                                    const ChunkIdentity& identity)
{
    std::uint64_t of_levels = 0;
    for (const std::uint32_t points : identity.level_points) of_levels += points;
    if (of_levels != chunk.points)
        throw Error(
            ErrorCode::invalid_argument, {},
            "a chunk of " + std::to_string(chunk.points) + " points whose levels have " + std::to_string(of_levels));
    if (const char* wrong = bpc_layout::wrong_with(identity)) throw Error(ErrorCode::invalid_argument, {}, wrong);
    if (chunk.points > 0) check(chunk, schema);

    std::vector<BpcSegment> segments = segments_of(identity, chunk.points);
    const bool wide = chunk.points > 0 && chunk.positions->wide;
    Payload payload(static_cast<std::size_t>(chunk.points) * 10);
    Box3i box;
    if (chunk.points > 0) {
        find_boxes(*chunk.positions, segments);
        for (const BpcSegment& segment : segments) box.extend(segment.box);
        if (box.min != chunk.positions->origin)
            throw Error(ErrorCode::invalid_argument, {}, "a chunk to encode whose origin is not its smallest corner");
        payload.add_positions(*chunk.positions, segments);
        for (const auto& column : chunk.attributes) payload.add(*column, segments, true);
        if (chunk.sizes) payload.add(*chunk.sizes, segments, true);
    } else {
        payload.columns.resize(1 + schema.size());
    }

    const bool sizes = chunk.points > 0 && chunk.sizes;
    ByteWriter out =
        put_head({bpc_layout::version_of_trees, grid.scale, grid.offset}, chunk.points, &identity, box,
                 (wide ? bpc_layout::has_wide_positions : 0) | (sizes ? bpc_layout::has_sizes : 0), schema);
    out.put(identity.part);
    out.put(identity.generation);
    out.put(identity.spacing);
    out.put(identity.first_level);
    out.put(static_cast<std::uint16_t>(identity.level_points.size()));
    for (const std::uint32_t points : identity.level_points) out.put(points);
    for (const BpcSegment& segment : segments)
        for (const Vec3i& corner : {segment.box.min, segment.box.max})
            for (std::size_t a = 0; a < 3; ++a) {
                const std::uint64_t relative =
                    static_cast<std::uint64_t>(corner[a]) - static_cast<std::uint64_t>(box.min[a]);
                if (wide)
                    out.put(relative);
                else
                    out.put(static_cast<std::uint32_t>(relative));
            }
    put_pieces(out, payload.columns[0]);
    for (std::size_t i = 0; i < schema.size(); ++i) {
        put_attribute(out, schema[i]);
        put_column(out, payload.columns[1 + i]);
    }
    if (sizes) put_column(out, payload.columns.back());
    return finish(out, payload.bytes);
}

}  // namespace pcm
