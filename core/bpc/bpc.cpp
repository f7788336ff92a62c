#include "bpc/bpc.h"

#include "bpc/byte_order.h"
#include "bpc/column_codec.h"
#include "cloud/error.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm {
namespace {

constexpr char magic[4] = {'B', 'P', 'C', '1'};
constexpr std::uint16_t version_on_grid = 1;
constexpr std::uint16_t version_of_doubles = 2;
constexpr std::size_t fixed_header = 168;
// A header is some hundred bytes; one of a file gone wrong shall not fill the memory.
constexpr std::uint32_t most_header_bytes = std::uint32_t{16} << 20;

// Raw scalars as unsigned words in the order of their values, so that near values have near words. Bijective.
template <class Word, class T>
Word to_word(T value)
{
    using Bits = std::conditional_t<sizeof(T) == 1, std::uint8_t,
                                    std::conditional_t<sizeof(T) == 2, std::uint16_t,
                                                       std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
    Bits bits;
    std::memcpy(&bits, &value, sizeof(T));
    constexpr Bits sign = static_cast<Bits>(Bits(1) << (sizeof(T) * 8 - 1));
    if constexpr (std::is_floating_point_v<T>)
        bits = static_cast<Bits>(bits & sign ? static_cast<Bits>(~bits) : static_cast<Bits>(bits | sign));
    else if constexpr (std::is_signed_v<T>)
        bits = static_cast<Bits>(bits ^ sign);
    return static_cast<Word>(bits);
}
template <class Word, class T>
T from_word(Word word)
{
    using Bits = std::conditional_t<sizeof(T) == 1, std::uint8_t,
                                    std::conditional_t<sizeof(T) == 2, std::uint16_t,
                                                       std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
    auto bits = static_cast<Bits>(word);
    constexpr Bits sign = static_cast<Bits>(Bits(1) << (sizeof(T) * 8 - 1));
    if constexpr (std::is_floating_point_v<T>)
        bits = static_cast<Bits>(bits & sign ? static_cast<Bits>(bits ^ sign) : static_cast<Bits>(~bits));
    else if constexpr (std::is_signed_v<T>)
        bits = static_cast<Bits>(bits ^ sign);
    T value;
    std::memcpy(&value, &bits, sizeof(T));
    return value;
}

template <class T>
void pack_scalars(const Column& column, std::size_t points, std::vector<std::byte>& out)
{
    using Word = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    std::vector<Word> words(points);
    const std::size_t n = column.components();
    const T* values = column.as<T>();
    for (std::size_t c = 0; c < n; ++c) {
        for (std::size_t i = 0; i < points; ++i) words[i] = to_word<Word>(values[i * n + c]);
        pack(words.data(), points, out);
    }
}

template <class T>
std::size_t unpack_scalars(const std::byte* data, std::size_t size, Column& column, const std::filesystem::path& path)
{
    using Word = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    const std::size_t points = column.size();
    std::vector<Word> words(points);
    const std::size_t n = column.components();
    T* values = column.as<T>();
    std::size_t used = 0;
    for (std::size_t c = 0; c < n; ++c) {
        used += unpack(data + used, size - used, words.data(), points, path);
        for (std::size_t i = 0; i < points; ++i) values[i * n + c] = from_word<Word, T>(words[i]);
    }
    return used;
}

template <class F>
auto with_scalar(ScalarType type, F&& f)
{
    switch (type) {
    case ScalarType::i8: return f(std::int8_t());
    case ScalarType::u8: return f(std::uint8_t());
    case ScalarType::i16: return f(std::int16_t());
    case ScalarType::u16: return f(std::uint16_t());
    case ScalarType::i32: return f(std::int32_t());
    case ScalarType::u32: return f(std::uint32_t());
    case ScalarType::i64: return f(std::int64_t());
    case ScalarType::u64: return f(std::uint64_t());
    case ScalarType::f32: return f(float());
    case ScalarType::f64: break;
    }
    return f(double());
}

void put_column(ByteWriter& out, const BpcColumn& column)
{
    out.put(column.offset);
    out.put(column.bytes);
    out.put(column.checksum);
}

BpcColumn get_column(ByteReader& in)
{
    BpcColumn column;
    column.offset = in.get<std::uint64_t>();
    column.bytes = in.get<std::uint64_t>();
    column.checksum = in.get<std::uint64_t>();
    return column;
}

template <class Vector>
std::shared_ptr<ChunkPositions> unpack_positions(const std::byte* data, std::size_t size, const BpcHeader& header,
                                                 Vector ChunkPositions::*member, const std::filesystem::path& path)
{
    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = header.box.min;
    positions->wide = header.wide;
    std::size_t used = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        auto& axis = ((*positions).*member)[a];
        axis.resize(header.points);
        used += unpack(data + used, size - used, axis.data(), axis.size(), path);
        const std::uint64_t limit =
            static_cast<std::uint64_t>(header.box.max[a]) - static_cast<std::uint64_t>(header.box.min[a]);
        if (static_cast<std::uint64_t>(*std::max_element(axis.begin(), axis.end())) > limit)
            throw Error(ErrorCode::corrupt, path, "a chunk's point lies outside the chunk's box");
    }
    if (used != size) throw Error(ErrorCode::corrupt, path, "a chunk's positions are followed by stray bytes");
    return positions;
}

}  // namespace

std::uint64_t checksum(const void* data, std::size_t bytes) { return XXH3_64bits(data, bytes); }

void put_attribute(ByteWriter& out, const Attribute& attribute)
{
    out.put(static_cast<std::uint8_t>(attribute.type));
    out.put(attribute.components);
    out.put(attribute.scale);
    out.put(attribute.offset);
    out.put_string(attribute.name);
    out.put_string(attribute.description);
}

Attribute get_attribute(ByteReader& in)
{
    Attribute attribute;
    attribute.type = static_cast<ScalarType>(in.get<std::uint8_t>());
    attribute.components = in.get<std::uint32_t>();
    attribute.scale = in.get<double>();
    attribute.offset = in.get<double>();
    attribute.name = in.get_string();
    attribute.description = in.get_string();
    return attribute;
}

namespace {

// How the integers of a chunk become coordinates, as its header says it.
struct Coding {
    std::uint16_t version;
    Vec3d first, second;  // scale and offset, or divisor and shift
};

std::vector<std::byte> encode(const Chunk& chunk, const Schema& schema, const Coding& coding, const NodePath& path)
{
    if (chunk.points == 0 || !chunk.positions || chunk.positions->size() != chunk.points ||
        chunk.attributes.size() != schema.size())
        throw Error(ErrorCode::invalid_argument, {}, "a chunk to encode lacks points or columns");

    const ChunkPositions& positions = *chunk.positions;
    Vec3i box_max = positions.origin;
    const auto extend = [&](const auto& axes) {
        for (std::size_t a = 0; a < 3; ++a)
            box_max[a] = static_cast<std::int64_t>(static_cast<std::uint64_t>(positions.origin[a]) +
                                                   *std::max_element(axes[a].begin(), axes[a].end()));
    };
    if (positions.wide)
        extend(positions.wide_xyz);
    else
        extend(positions.narrow_xyz);

    // The payload first, since the header holds its lengths.
    std::vector<std::byte> payload;
    payload.reserve(static_cast<std::size_t>(chunk.points) * 10);
    std::vector<BpcColumn> columns(1 + schema.size());
    const auto finish_column = [&](BpcColumn& column, std::size_t start) {
        column.offset = start;
        column.bytes = payload.size() - start;
        column.checksum = checksum(payload.data() + start, payload.size() - start);
    };
    for (std::size_t a = 0; a < 3; ++a) {
        if (positions.wide)
            pack(positions.wide_xyz[a].data(), chunk.points, payload);
        else
            pack(positions.narrow_xyz[a].data(), chunk.points, payload);
    }
    finish_column(columns[0], 0);
    for (std::size_t i = 0; i < schema.size(); ++i) {
        const Column* column = chunk.attributes[i].get();
        if (!column || column->size() != chunk.points || column->type() != schema[i].type ||
            column->components() != schema[i].components)
            throw Error(ErrorCode::invalid_argument, {},
                        "a chunk to encode lacks attribute '" + schema[i].name + "'");
        const std::size_t start = payload.size();
        with_scalar(schema[i].type, [&](auto scalar) {
            pack_scalars<decltype(scalar)>(*column, chunk.points, payload);
            return 0;
        });
        finish_column(columns[1 + i], start);
    }

    ByteWriter out;
    out.put_bytes(magic, 4);
    out.put(coding.version);
    out.put(path.depth);
    out.put(path.bits[0]);
    out.put(path.bits[1]);
    out.put(std::uint32_t(0));  // header bytes, below
    out.put(chunk.points);
    out.put(std::uint64_t(0));  // total bytes, below
    for (const double v : coding.first) out.put(v);
    for (const double v : coding.second) out.put(v);
    for (std::size_t a = 0; a < 3; ++a) out.put(positions.origin[a]);
    for (std::size_t a = 0; a < 3; ++a) out.put(box_max[a]);
    out.put(static_cast<std::uint32_t>(positions.wide));
    out.put(static_cast<std::uint32_t>(schema.size()));
    // header_bytes shifts the columns' offsets, so their places are filled in when it is known.
    std::vector<std::size_t> places;
    places.push_back(out.size());
    put_column(out, columns[0]);
    for (std::size_t i = 0; i < schema.size(); ++i) {
        put_attribute(out, schema[i]);
        places.push_back(out.size());
        put_column(out, columns[1 + i]);
    }
    const std::size_t header_bytes = out.size() + 8;
    out.set(24, static_cast<std::uint32_t>(header_bytes));
    out.set(32, static_cast<std::uint64_t>(header_bytes + payload.size()));
    for (std::size_t i = 0; i < places.size(); ++i) out.set(places[i], columns[i].offset + header_bytes);
    out.put(checksum(out.bytes().data(), out.size()));

    std::vector<std::byte> bytes = std::move(out.bytes());
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    return bytes;
}

// Whether `bytes` can be `sequences` packed sequences of `points` words each.
bool can_be_packed(std::uint64_t bytes, std::uint64_t sequences, std::uint64_t points, std::uint64_t word_bytes)
{
    const std::uint64_t blocks = (points + codec_block - 1) / codec_block;
    const std::uint64_t least = 16, most = 16 + blocks * (2 + word_bytes + codec_block * word_bytes);
    return bytes / least >= sequences && (bytes / most < sequences || bytes == sequences * most);
}

}  // namespace

std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid, const NodePath& path)
{
    return encode(chunk, schema, {version_on_grid, grid.scale, grid.offset}, path);
}

std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const DoubleCodes& doubles)
{
    const Vec3d shift{double(doubles.shift[0]), double(doubles.shift[1]), double(doubles.shift[2])};
    return encode(chunk, schema, {version_of_doubles, doubles.divisor, shift}, {});
}

BpcHeader decode_header(const std::byte* data, std::size_t size, const std::filesystem::path& path)
{
    ByteReader in(data, size, path);
    if (size < fixed_header) throw Error(ErrorCode::corrupt, path, "a chunk is shorter than its header");
    if (std::memcmp(in.get_bytes(4), magic, 4) != 0) throw Error(ErrorCode::corrupt, path, "no chunk where one should be");
    const auto found = in.get<std::uint16_t>();
    if (found != version_on_grid && found != version_of_doubles)
        throw Error(ErrorCode::unsupported, path,
                    "chunk format version " + std::to_string(found) + ", this program reads versions 1 and 2");
    BpcHeader header;
    header.path.depth = in.get<std::uint16_t>();
    header.path.bits = {in.get<std::uint64_t>(), 0};
    header.path.bits[1] = in.get<std::uint64_t>();
    header.header_bytes = in.get<std::uint32_t>();
    header.points = in.get<std::uint32_t>();
    header.total_bytes = in.get<std::uint64_t>();
    // The smallest header has a checksum behind its fixed part.
    if (header.header_bytes < fixed_header + 8 || header.header_bytes > size || header.header_bytes > header.total_bytes)
        throw Error(ErrorCode::corrupt, path, "a chunk's header length is impossible");
    std::uint64_t stored;
    std::memcpy(&stored, data + header.header_bytes - 8, 8);
    if (stored != checksum(data, header.header_bytes - 8))
        throw Error(ErrorCode::corrupt, path, "the checksum of a chunk's header does not hold");
    // From here on the bytes are as they were written; what follows guards against a writer gone wrong.
    if (header.path.depth > NodePath::max_depth || header.points == 0)
        throw Error(ErrorCode::corrupt, path, "a chunk's header makes no sense");
    if (found == version_on_grid) {
        for (double& s : header.grid.scale) s = in.get<double>();
        for (double& o : header.grid.offset) o = in.get<double>();
    } else {
        Vec3d divisor, shift;
        for (double& d : divisor) d = in.get<double>();
        for (double& s : shift) s = in.get<double>();
        header.doubles = DoubleCodes::checked(divisor, shift);
        if (!header.doubles) throw Error(ErrorCode::corrupt, path, "a chunk's coding of doubles makes no sense");
    }
    for (std::int64_t& v : header.box.min) v = in.get<std::int64_t>();
    for (std::int64_t& v : header.box.max) v = in.get<std::int64_t>();
    header.wide = in.get<std::uint32_t>() != 0;
    const auto attributes = in.get<std::uint32_t>();
    const auto place = [&](BpcColumn column, std::uint64_t sequences, std::uint64_t word_bytes) {
        if (column.offset < header.header_bytes || column.offset > header.total_bytes ||
            column.bytes > header.total_bytes - column.offset)
            throw Error(ErrorCode::corrupt, path, "a column lies outside its chunk");
        if (!can_be_packed(column.bytes, sequences, header.points, word_bytes))
            throw Error(ErrorCode::corrupt, path,
                        "a column of " + std::to_string(column.bytes) + " bytes cannot hold the chunk's " +
                            std::to_string(header.points) + " points");
        return column;
    };
    header.positions = place(get_column(in), 3, header.wide ? 8 : 4);
    if (attributes > max_attributes) throw Error(ErrorCode::corrupt, path, "a chunk's header makes no sense");
    for (std::uint32_t i = 0; i < attributes; ++i) {
        const Attribute attribute = get_attribute(in);
        header.schema.add(attribute);
        header.attributes.push_back(place(get_column(in), attribute.components, size_of(attribute.type) == 8 ? 8 : 4));
    }
    for (std::size_t a = 0; a < 3; ++a)
        if (header.box.min[a] > header.box.max[a] ||
            (!header.wide && static_cast<std::uint64_t>(header.box.max[a]) -
                                     static_cast<std::uint64_t>(header.box.min[a]) >
                                 std::numeric_limits<std::uint32_t>::max()))
            throw Error(ErrorCode::corrupt, path, "a chunk's box makes no sense");
    return header;
}

namespace {

// The first bytes of a chunk, its whole header among them.
std::vector<std::byte> read_head(const File& file, std::uint64_t offset, std::uint64_t available, std::size_t guess)
{
    std::vector<std::byte> head(static_cast<std::size_t>(std::min<std::uint64_t>(available, guess)));
    file.read_at(head.data(), head.size(), offset);
    if (head.size() >= 28 && std::memcmp(head.data(), magic, 4) == 0) {
        std::uint32_t header_bytes;
        std::memcpy(&header_bytes, head.data() + 24, 4);
        if (header_bytes > head.size() && header_bytes <= available && header_bytes <= most_header_bytes) {
            const std::size_t have = head.size();
            head.resize(header_bytes);
            file.read_at(head.data() + have, header_bytes - have, offset + have);
        }
    }
    return head;
}

// Errors from inside the chunk's bytes name no file: adds it, and where the chunk lies.
[[noreturn]] void rethrow_naming(const Error& error, const File& file, std::uint64_t offset)
{
    if (!error.path().empty()) throw;
    throw Error(error.code(), file.path(), "chunk at byte " + std::to_string(offset) + ": " + error.what());
}

}  // namespace

BpcHeader read_header(const File& file, std::uint64_t offset, std::uint64_t available)
{
    try {
        const std::vector<std::byte> head = read_head(file, offset, available, 4096);
        BpcHeader header = decode_header(head.data(), head.size(), {});
        if (header.total_bytes > available)
            throw Error(ErrorCode::truncated, {},
                        "its header says that it has " + std::to_string(header.total_bytes) + " bytes; " +
                            std::to_string(available) + " are left");
        return header;
    } catch (const Error& error) {
        rethrow_naming(error, file, offset);
    }
}

DecodedChunk read_chunk(const File& file, std::uint64_t offset, std::uint64_t bytes, std::uint32_t header_bytes,
                        const ColumnSet& columns, ChunkPositionsMayBe positions_may_be)
{
    // Where everything is asked for, one read serves; else the header, then each run of neighbouring columns.
    try {
        if (bytes < fixed_header) throw Error(ErrorCode::corrupt, {}, "shorter than a chunk's header");
        if (header_bytes > bytes) throw Error(ErrorCode::corrupt, {}, "shorter than its header");
        const std::vector<std::byte> head = read_head(file, offset, bytes, header_bytes ? header_bytes : 65536);
        DecodedChunk result;
        result.header = decode_header(head.data(), head.size(), {});
        const BpcHeader& header = result.header;
        if (header.doubles && positions_may_be == ChunkPositionsMayBe::on_grid)
            throw Error(ErrorCode::unsupported, {}, "its positions are doubles; a chunk on a grid was expected");
        if (header.total_bytes != bytes) throw Error(ErrorCode::corrupt, {}, "its length is not the one in the index");
        result.chunk.points = header.points;
        result.chunk.attributes.resize(header.schema.size());

        struct Wanted {
            const BpcColumn* column;
            int attribute;  // -1: positions
        };
        std::vector<Wanted> wanted;
        if (columns.positions) wanted.push_back({&header.positions, -1});
        for (std::size_t i = 0; i < header.schema.size(); ++i)
            if (columns.attributes.test(i)) wanted.push_back({&header.attributes[i], static_cast<int>(i)});
        std::vector<std::byte> buffer;
        for (std::size_t from = 0; from < wanted.size();) {
            std::size_t to = from + 1;
            while (to < wanted.size() &&
                   wanted[to].column->offset == wanted[to - 1].column->offset + wanted[to - 1].column->bytes)
                ++to;
            const std::uint64_t run_start = wanted[from].column->offset;
            const auto run_bytes =
                static_cast<std::size_t>(wanted[to - 1].column->offset + wanted[to - 1].column->bytes - run_start);
            buffer.resize(run_bytes + codec_slack);
            file.read_at(buffer.data(), run_bytes, offset + run_start);
            for (; from < to; ++from) {
                const BpcColumn& column = *wanted[from].column;
                const std::byte* data = buffer.data() + (column.offset - run_start);
                const auto size = static_cast<std::size_t>(column.bytes);
                const std::string name =
                    wanted[from].attribute < 0 ? "positions" : header.schema[static_cast<std::size_t>(wanted[from].attribute)].name;
                if (checksum(data, size) != column.checksum)
                    throw Error(ErrorCode::corrupt, {}, "the checksum of '" + name + "' does not hold");
                if (wanted[from].attribute < 0) {
                    result.chunk.positions =
                        header.wide ? unpack_positions(data, size, header, &ChunkPositions::wide_xyz, {})
                                    : unpack_positions(data, size, header, &ChunkPositions::narrow_xyz, {});
                } else {
                    const auto i = static_cast<std::size_t>(wanted[from].attribute);
                    auto values = std::make_shared<Column>(header.schema[i]);
                    values->resize(header.points);
                    const std::size_t used = with_scalar(header.schema[i].type, [&](auto scalar) {
                        return unpack_scalars<decltype(scalar)>(data, size, *values, {});
                    });
                    if (used != size) throw Error(ErrorCode::corrupt, {}, "'" + name + "' is followed by stray bytes");
                    result.chunk.attributes[i] = std::move(values);
                }
            }
        }
        return result;
    } catch (const Error& error) {
        rethrow_naming(error, file, offset);
    }
}

}  // namespace pcm
