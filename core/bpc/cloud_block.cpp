#include "pcm/bpc/cloud_block.h"

#include "pcm/bpc/attribute_bytes.h"
#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

namespace pcm {
namespace {

constexpr std::string_view table_magic = "BPCTABLE";
constexpr std::uint32_t block_version = 1;
constexpr std::size_t block_head_bytes = 148;  // up to the attributes
constexpr std::size_t least_block_bytes = block_head_bytes + 4 + 8;
constexpr std::size_t row_bytes = 16;
constexpr std::size_t table_overhead = 8 + 8;
constexpr std::uint64_t least_chunk_bytes = 168 + 8 + 48;

std::string at(std::uint64_t byte) { return " at byte " + std::to_string(byte); }

[[noreturn]] void fail_block(const File& file, ErrorCode code, const std::string& what)
{
    throw Error(code, file.path(), "cloud block: " + what);
}

// The bytes of the block, whose length and checksum are right.
std::vector<std::byte> read_block_bytes(const File& file, std::uint64_t file_bytes)
{
    const auto fail = [&](ErrorCode code, const std::string& what) { fail_block(file, code, what); };
    std::array<std::byte, 24> start;
    file.read_at(start.data(), start.size(), 0);
    ByteReader first(start.data(), start.size(), file.path());
    first.get_bytes(8);
    const auto found = first.get<std::uint32_t>();
    if (found != block_version)
        fail(ErrorCode::unsupported, "version " + std::to_string(found) + at(8) + ", this program reads version " +
                                         std::to_string(block_version));
    first.get<std::uint32_t>();
    const auto size = first.get<std::uint64_t>();
    if (size < least_block_bytes || size > most_cloud_block_bytes)
        fail(ErrorCode::corrupt, "a length of " + std::to_string(size) + " bytes" + at(16) + "; " +
                                     std::to_string(least_block_bytes) + " to " +
                                     std::to_string(most_cloud_block_bytes) + " were expected");
    if (size > file_bytes)
        fail(ErrorCode::truncated, "it has " + std::to_string(size) + " bytes, the file ends" + at(file_bytes));

    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    file.read_at(bytes.data(), bytes.size(), 0);
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + bytes.size() - 8, 8);
    if (stored != checksum(bytes.data(), bytes.size() - 8))
        fail(ErrorCode::corrupt, "its checksum" + at(size - 8) + " does not match");
    return bytes;
}

}  // namespace

std::vector<std::byte> encode_cloud_block(const BpcCloud& cloud, std::uint64_t table_offset)
{
    std::uint64_t payload = 0;
    for (const Metadata& block : cloud.metadata) payload += 12 + block.key.size() + block.value.size();
    for (const Attribute& a : cloud.schema) payload += 32 + a.name.size() + a.description.size();
    if (payload > most_cloud_block_bytes - least_block_bytes)
        throw Error(ErrorCode::unsupported, {},
                    "the cloud's metadata have " + std::to_string(payload) + " bytes; a BPC can have at most " +
                        std::to_string(most_cloud_block_bytes));
    ByteWriter out;
    out.put_bytes(cloud_block_magic.data(), cloud_block_magic.size());
    out.put(block_version);
    out.put(static_cast<std::uint8_t>(cloud.position_type));
    out.put(static_cast<std::uint8_t>(cloud.grid.has_value()));
    out.put(std::uint16_t{0});
    out.put(std::uint64_t{0});  // size of the block, set below
    out.put(cloud.points);
    out.put(cloud.chunks);
    out.put(table_offset);
    const Grid grid = cloud.grid.value_or(Grid{});
    for (const double v : grid.scale) out.put(v);
    for (const double v : grid.offset) out.put(v);
    const Box3d box = cloud.box.value_or(Box3d{});
    for (const double v : box.min) out.put(v);
    for (const double v : box.max) out.put(v);
    out.put(static_cast<std::uint32_t>(cloud.schema.size()));
    for (const Attribute& attribute : cloud.schema) put_attribute(out, attribute);
    out.put(static_cast<std::uint32_t>(cloud.metadata.size()));
    for (const Metadata& block : cloud.metadata) {
        out.put_string(block.key);
        out.put(static_cast<std::uint64_t>(block.value.size()));
        out.put_bytes(block.value.data(), block.value.size());
    }
    out.set(16, static_cast<std::uint64_t>(out.size() + 8));
    out.put(checksum(out.bytes().data(), out.size()));
    return std::move(out.bytes());
}

bool has_cloud_block(const File& file)
{
    std::array<char, cloud_block_magic.size()> start{};
    return file.read_some_at(start.data(), start.size(), 0) == start.size() &&
           std::string_view(start.data(), start.size()) == cloud_block_magic;
}

CloudBlock read_cloud_block(const File& file, std::uint64_t file_bytes)
{
    const auto fail = [&](ErrorCode code, const std::string& what) { fail_block(file, code, what); };
    const std::vector<std::byte> bytes = read_block_bytes(file, file_bytes);
    CloudBlock block;
    block.bytes = bytes.size();
    // The bytes are as they were written; the following checks guard against a faulty writer.
    ByteReader in(bytes.data(), bytes.size() - 8, file.path());
    in.get_bytes(12);
    BpcCloud& cloud = block.cloud;
    cloud.position_type = static_cast<ScalarType>(in.get<std::uint8_t>());
    const bool on_grid = in.get<std::uint8_t>() != 0;
    in.get_bytes(2 + 8);
    cloud.points = in.get<std::uint64_t>();
    cloud.chunks = in.get<std::uint64_t>();
    block.table_offset = in.get<std::uint64_t>();
    if (!is_valid(cloud.position_type)) fail(ErrorCode::corrupt, "no scalar type" + at(12));
    Grid grid;
    for (double& v : grid.scale) v = in.get<double>();
    for (double& v : grid.offset) v = in.get<double>();
    Box3d box;
    for (double& v : box.min) v = in.get<double>();
    for (double& v : box.max) v = in.get<double>();
    if (on_grid) cloud.grid = grid;
    if (!box.empty()) cloud.box = box;
    for (std::size_t a = 0; a < 3; ++a) {
        if (on_grid && (!(grid.scale[a] > 0) || !std::isfinite(grid.scale[a]) || !std::isfinite(grid.offset[a])))
            fail(ErrorCode::corrupt, "its grid" + at(48) + " has no positive scales and finite offsets");
        if (cloud.box && !(std::isfinite(box.min[a]) && std::isfinite(box.max[a]))) cloud.box.reset();
    }
    const auto attributes = in.get<std::uint32_t>();
    if (attributes > max_attributes) fail(ErrorCode::corrupt, std::to_string(attributes) + " attributes" + at(144));
    for (std::uint32_t i = 0; i < attributes; ++i) {
        const Attribute attribute = get_attribute(in);
        if (attribute.name.empty() || !is_valid(attribute.type) || attribute.components == 0 ||
            cloud.schema.find(attribute.name))
            fail(ErrorCode::corrupt, "attribute " + std::to_string(i) + " is invalid");
        cloud.schema.add(attribute);
    }
    const auto blocks = in.get<std::uint32_t>();
    for (std::uint32_t i = 0; i < blocks; ++i) {
        Metadata metadata;
        metadata.key = in.get_string();
        const auto size = in.get<std::uint64_t>();
        if (size > in.left()) fail(ErrorCode::corrupt, "metadata '" + metadata.key + "' reach past its end");
        const std::byte* value = in.get_bytes(static_cast<std::size_t>(size));
        metadata.value.assign(value, value + size);
        cloud.metadata.push_back(std::move(metadata));
    }
    if (in.left() != 0) fail(ErrorCode::corrupt, std::to_string(in.left()) + " stray bytes after the metadata");
    return block;
}

std::vector<std::byte> encode_chunk_table(const std::vector<ChunkSize>& chunks)
{
    ByteWriter out;
    out.bytes().reserve(table_overhead + row_bytes * chunks.size());
    out.put_bytes(table_magic.data(), table_magic.size());
    for (const ChunkSize& chunk : chunks) {
        out.put(chunk.points);
        out.put(chunk.bytes);
    }
    out.put(checksum(out.bytes().data(), out.size()));
    return std::move(out.bytes());
}

ChunkIndex read_chunk_table(const File& file, std::uint64_t file_bytes, const CloudBlock& block)
{
    const auto fail = [&](ErrorCode code, const std::string& what) {
        throw Error(code, file.path(), "chunk table: " + what);
    };
    const std::uint64_t chunks = block.cloud.chunks, start = block.table_offset;
    if (start > file_bytes || start < block.bytes)
        fail(start < block.bytes ? ErrorCode::corrupt : ErrorCode::truncated,
             "its offset is" + at(start) + "; the chunks begin" + at(block.bytes) + " and the file ends" +
                 at(file_bytes));
    const std::uint64_t bytes = file_bytes - start;
    const std::uint64_t rows = bytes < table_overhead ? 0 : (bytes - table_overhead) / row_bytes;
    if (bytes < table_overhead || rows < chunks)
        fail(ErrorCode::truncated, "the file ends" + at(file_bytes) + "; a table of " + std::to_string(chunks) +
                                       " chunks was expected from byte " + std::to_string(start));
    if (bytes != table_overhead + row_bytes * chunks)
        fail(ErrorCode::corrupt, "stray bytes after its end" + at(start + table_overhead + row_bytes * chunks));

    // Piece by piece, since there may be many chunks.
    RunningChecksum sum;
    std::array<std::byte, 8> magic;
    file.read_at(magic.data(), magic.size(), start);
    if (std::memcmp(magic.data(), table_magic.data(), magic.size()) != 0)
        fail(ErrorCode::corrupt, "there is none" + at(start));
    sum.add(magic.data(), magic.size());

    ChunkIndex index(block.bytes);
    std::vector<std::byte> piece;
    for (std::uint64_t row = 0; row < chunks;) {
        const std::uint64_t now = std::min<std::uint64_t>(chunks - row, 4096);
        piece.resize(static_cast<std::size_t>(now) * row_bytes);
        file.read_at(piece.data(), piece.size(), start + 8 + row * row_bytes);
        sum.add(piece.data(), piece.size());
        ByteReader in(piece.data(), piece.size(), file.path());
        for (std::uint64_t i = 0; i < now; ++i, ++row) {
            const auto chunk_points = in.get<std::uint64_t>(), chunk_bytes = in.get<std::uint64_t>();
            if (chunk_points == 0 || chunk_points > std::numeric_limits<std::uint32_t>::max() ||
                chunk_bytes < least_chunk_bytes || chunk_bytes > start - index.end().offset)
                fail(ErrorCode::corrupt, "the row of chunk " + std::to_string(row) + at(start + 8 + row * row_bytes) +
                                             " has " + std::to_string(chunk_points) + " points in " +
                                             std::to_string(chunk_bytes) + " bytes, which is impossible");
            index.add(chunk_points, chunk_bytes);
        }
    }
    std::uint64_t stored;
    file.read_at(&stored, 8, file_bytes - 8);
    if (stored != sum.value()) fail(ErrorCode::corrupt, "its checksum" + at(file_bytes - 8) + " does not match");
    if (index.end().offset != start || index.end().first_point != block.cloud.points)
        fail(ErrorCode::corrupt, "its chunks have " + std::to_string(index.end().first_point) + " points and end" +
                                     at(index.end().offset) + "; the cloud block has " +
                                     std::to_string(block.cloud.points) + " points that end" + at(start));
    return index;
}

}  // namespace pcm
