// Headers whose checksum matches, and which no writer has made: refused as corrupt, before they cost memory.

#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/chunk_header.h"
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

// Equal values take no bytes, so the size of the file says nothing of the memory: 4096 points of two million
// components.
TEST(CraftedHeader, VeryManyEqualValues)
{
    Schema schema;
    schema.add({"wide", ScalarType::u8, 1900000, 1, 0, ""});
    std::vector<std::byte> bytes = encode_chunk(equal_points(schema, 1), schema, Grid(), identity_of(1));
    for (const std::uint32_t points : {std::uint32_t(2), std::uint32_t(4096)}) {
        std::memcpy(bytes.data() + 28, &points, 4);
        std::memcpy(bytes.data() + 164, &points, 4);  // points of its only level
        seal(bytes);
        if (points == 4096) {
            EXPECT_EQ(refusal(bytes), ErrorCode::corrupt);
        } else {
            EXPECT_NO_THROW(decode_header(bytes.data(), bytes.size(), {}));
        }
    }
}

// The bytes behind those that may be read, and those before the fixed part's end, are not looked at.
TEST(CraftedHeader, LengthsThatAreNotInTheBytes)
{
    const Schema schema;
    const std::vector<std::byte> good = encode_chunk(equal_points(schema, 100), schema, Grid());
    const std::uint32_t header_bytes = decode_header(good.data(), good.size(), {}).header_bytes;
    const auto message = [](const std::vector<std::byte>& bytes, std::size_t size) -> std::string {
        try {
            decode_header(bytes.data(), size, {});
        } catch (const Error& error) {
            return error.code() == ErrorCode::corrupt ? error.what() : "another code";
        }
        return "";
    };
    EXPECT_EQ(message(good, header_bytes), "");
    for (std::size_t size = bpc_layout::fixed_header; size < header_bytes; ++size)
        EXPECT_NE(message(good, size).find("header length is impossible"), std::string::npos) << size;
    for (std::uint32_t length = 64; length < bpc_layout::fixed_header + 8; ++length) {
        std::vector<std::byte> bytes = good;
        std::memcpy(bytes.data() + bpc_layout::header_bytes_at, &length, 4);
        seal(bytes);
        EXPECT_NE(message(bytes, bytes.size()).find("header length is impossible"), std::string::npos) << length;
    }
}

}  // namespace
