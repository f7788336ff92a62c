// Headers whose checksum matches, and which no writer has made: refused as corrupt, before they cost memory.

#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/layout.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <algorithm>
#include <cstring>

namespace {

using namespace pcm;
using namespace pcm::test;

Chunk equal_points(const Schema& schema, std::uint32_t points)
{
    Chunk chunk;
    chunk.points = points;
    auto positions = std::make_shared<ChunkPositions>();
    for (auto& axis : positions->narrow_xyz) axis.assign(points, 0);
    chunk.positions = positions;
    for (const Attribute& attribute : schema) {
        const auto column = std::make_shared<Column>(attribute);
        column->resize(points);
        chunk.attributes.push_back(column);
    }
    return chunk;
}

ChunkIdentity identity_of(std::uint32_t points)
{
    ChunkIdentity identity;
    identity.part = 0;
    identity.generation = 1;
    identity.level_points = {points};
    return identity;
}

void seal(std::vector<std::byte>& bytes)
{
    std::uint32_t header_bytes = 0;
    std::memcpy(&header_bytes, bytes.data() + bpc_layout::header_bytes_at, 4);
    const std::uint64_t sum = checksum(bytes.data(), header_bytes - 8);
    std::memcpy(bytes.data() + header_bytes - 8, &sum, 8);
}

ErrorCode refusal(const std::vector<std::byte>& bytes)
{
    const TemporaryFolder folder;
    File file(folder / "chunk", File::Mode::create_new);
    file.write_at(bytes.data(), bytes.size(), 0);
    try {
        read_chunk(file, 0, bytes.size(), 0, {});
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find((folder / "chunk").string()), std::string::npos) << error.what();
        return error.code();
    }
    ADD_FAILURE() << "not refused";
    return ErrorCode::io;
}

TEST(CraftedHeader, OneAttributeTwice)
{
    Schema schema;
    schema.add({"first", ScalarType::u8, 1, 1, 0, ""});
    schema.add({"other", ScalarType::u8, 1, 1, 0, ""});
    const Chunk chunk = equal_points(schema, 100);
    for (std::vector<std::byte> bytes :
         {encode_chunk(chunk, schema, Grid()), encode_chunk(chunk, schema, Grid(), identity_of(100))}) {
        const std::string name = "other";
        const auto at = std::search(bytes.begin(), bytes.end(), name.begin(), name.end(),
                                    [](std::byte a, char b) { return a == static_cast<std::byte>(b); });
        ASSERT_NE(at, bytes.end());
        std::memcpy(&*at, "first", 5);
        seal(bytes);
        EXPECT_EQ(refusal(bytes), ErrorCode::corrupt);
    }
}

// Equal values take no bytes, so the size of the file says nothing of the memory.
TEST(CraftedHeader, FourBillionEqualPoints)
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    std::vector<std::byte> bytes = encode_chunk(equal_points(schema, 100), schema, Grid());
    const std::uint32_t points = 0xffffffff;
    std::memcpy(bytes.data() + 28, &points, 4);
    seal(bytes);
    EXPECT_EQ(refusal(bytes), ErrorCode::corrupt);
}

// One attribute of very many components, the same in all points.
TEST(CraftedHeader, AWideConstant)
{
    Schema schema;
    schema.add({"wide", ScalarType::u8, 1000, 1, 0, ""});
    const std::uint32_t points = 1000;
    std::vector<std::byte> bytes = encode_chunk(equal_points(schema, points), schema, Grid(), identity_of(points));
    const DecodedChunk decoded = [&] {
        const TemporaryFolder folder;
        File file(folder / "chunk", File::Mode::create_new);
        file.write_at(bytes.data(), bytes.size(), 0);
        return read_chunk(file, 0, bytes.size(), 0, ColumnSet::all(schema));
    }();
    EXPECT_EQ(decoded.chunk.points, points);
    EXPECT_EQ(bpc_layout::decoded_bytes(points, false, schema), 1012u * points);
    EXPECT_GT(bpc_layout::decoded_bytes(0xffffffff, true, schema), bpc_layout::most_decoded_bytes);
}

}  // namespace
