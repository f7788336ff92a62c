#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_encoder.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

namespace {

using pcm::test::TemporaryFolder;

pcm::Schema every_type()
{
    pcm::Schema schema;
    for (const auto type :
         {pcm::ScalarType::i8, pcm::ScalarType::u8, pcm::ScalarType::i16, pcm::ScalarType::u16, pcm::ScalarType::i32,
          pcm::ScalarType::u32, pcm::ScalarType::i64, pcm::ScalarType::u64, pcm::ScalarType::f32, pcm::ScalarType::f64})
        schema.add(
            {std::string(pcm::name_of(type)) + "s", type, 1 + static_cast<std::uint32_t>(type) % 3, 0.5, 10, "d"});
    return schema;
}

// Every bit pattern may occur, NaN and negative zero among floats included: columns are carried, not interpreted.
pcm::Chunk random_chunk(const pcm::Schema& schema, std::uint32_t points, bool wide, std::mt19937_64& random)
{
    pcm::Chunk chunk;
    chunk.points = points;
    auto positions = std::make_shared<pcm::ChunkPositions>();
    positions->origin = {static_cast<std::int64_t>(random()) / 4, -5, 1000};
    positions->wide = wide;
    for (std::size_t a = 0; a < 3; ++a) {
        positions->narrow_xyz[a].resize(wide ? 0 : points);
        positions->wide_xyz[a].resize(wide ? points : 0);
        for (auto& v : positions->narrow_xyz[a]) v = static_cast<std::uint32_t>(random() >> 40);
        for (auto& v : positions->wide_xyz[a]) v = random() >> 4;
        // The origin is the smallest coordinate.
        if (wide)
            positions->wide_xyz[a][0] = 0;
        else
            positions->narrow_xyz[a][0] = 0;
    }
    chunk.positions = positions;
    for (const pcm::Attribute& attribute : schema) {
        auto column = std::make_shared<pcm::Column>(attribute);
        column->resize(points);
        for (std::size_t i = 0; i < column->bytes(); ++i) column->data()[i] = static_cast<std::byte>(random());
        chunk.attributes.push_back(column);
    }
    return chunk;
}

pcm::File written(const std::filesystem::path& path, const std::vector<std::byte>& bytes, std::size_t gap = 0)
{
    // Some file systems flush a file to disk that was truncated and written again: tests do that thousands of times.
    std::filesystem::remove(path);
    pcm::File file(path, pcm::File::Mode::create_new);
    file.write_at(bytes.data(), bytes.size(), gap);
    return file;
}

void expect_equal(const pcm::Chunk& a, const pcm::Chunk& b, const pcm::ColumnSet& columns)
{
    ASSERT_EQ(a.points, b.points);
    ASSERT_EQ(b.positions != nullptr, columns.positions);
    if (columns.positions) {
        EXPECT_EQ(a.positions->origin, b.positions->origin);
        for (std::size_t i = 0; i < a.points; ++i) ASSERT_EQ(a.positions->grid(i), b.positions->grid(i));
    }
    for (std::size_t i = 0; i < a.attributes.size(); ++i) {
        ASSERT_EQ(b.attributes[i] != nullptr, columns.attributes.test(i));
        if (b.attributes[i])
            EXPECT_EQ(std::memcmp(a.attributes[i]->data(), b.attributes[i]->data(), a.attributes[i]->bytes()), 0) << i;
    }
}

TEST(Bpc, EveryTypeBitForBit)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(1);
    const pcm::Schema schema = every_type();
    pcm::Grid grid;
    grid.scale = {0.001, 0.002, 1e-7};
    grid.offset = {5e6, -3, 0};
    for (const bool wide : {false, true})
        for (const std::uint32_t points : {1u, 127u, 128u, 129u, 1000u}) {
            const pcm::Chunk chunk = random_chunk(schema, points, wide, random);
            const auto bytes = pcm::encode_chunk(chunk, schema, grid);
            const pcm::File file = written(folder / "chunk", bytes, 777);
            const auto back = pcm::read_chunk(file, 777, bytes.size(), 0, pcm::ColumnSet::all(schema));
            EXPECT_FALSE(back.header.identity);
            EXPECT_EQ(back.header.grid, grid);
            EXPECT_EQ(back.header.schema, schema);
            expect_equal(chunk, back.chunk, pcm::ColumnSet::all(schema));
        }
}

TEST(Bpc, OnlyWhatIsAskedForIsRead)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(2);
    const pcm::Schema schema = every_type();
    const pcm::Chunk chunk = random_chunk(schema, 500, false, random);
    auto bytes = pcm::encode_chunk(chunk, schema, pcm::Grid());
    const pcm::BpcHeader header = pcm::decode_header(bytes.data(), bytes.size(), {});
    for (int round = 0; round < 200; ++round) {
        pcm::ColumnSet columns;
        columns.positions = random() & 1;
        for (std::size_t i = 0; i < schema.size(); ++i) columns.attributes.set(i, random() & 1);
        // Damage every column that is not read: that must not matter.
        std::vector<std::byte> damaged = bytes;
        const auto damage = [&](const pcm::BpcColumn& column) {
            damaged[column.offset + column.bytes / 2] ^= std::byte(1);
        };
        if (!columns.positions) damage(header.positions);
        for (std::size_t i = 0; i < schema.size(); ++i)
            if (!columns.attributes.test(i)) damage(header.attributes[i]);
        const pcm::File file = written(folder / "chunk", damaged);
        expect_equal(chunk, pcm::read_chunk(file, 0, bytes.size(), header.header_bytes, columns).chunk, columns);
    }
}

TEST(Bpc, AnyChangedByteIsRefused)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(3);
    const pcm::Schema schema = every_type();
    const auto bytes = pcm::encode_chunk(random_chunk(schema, 60, false, random), schema, pcm::Grid());
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::vector<std::byte> damaged = bytes;
        damaged[at] ^= static_cast<std::byte>(1 + random() % 255);
        const pcm::File file = written(folder / "chunk", damaged);
        try {
            pcm::read_chunk(file, 0, bytes.size(), 0, pcm::ColumnSet::all(schema));
            ADD_FAILURE() << "byte " << at << " was changed and nobody noticed";
        } catch (const pcm::Error& error) {
            EXPECT_NE(std::string(error.what()).find("chunk at byte 0"), std::string::npos) << error.what();
        }
    }
}

TEST(Bpc, TruncationIsRefusedAtEveryLength)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(4);
    const pcm::Schema schema = every_type();
    const auto bytes = pcm::encode_chunk(random_chunk(schema, 20, true, random), schema, pcm::Grid());
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const pcm::File file =
            written(folder / "chunk", {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)});
        EXPECT_THROW(pcm::read_chunk(file, 0, bytes.size(), 0, pcm::ColumnSet::all(schema)), pcm::Error);
        if (length) EXPECT_THROW(pcm::read_chunk(file, 0, length, 0, pcm::ColumnSet::all(schema)), pcm::Error);
    }
}

// Version 1, byte by byte, as FORMAT.md lays it out. If this test fails, the format has changed: give it a new version.
TEST(Bpc, FrozenBytes)
{
    pcm::Schema schema;
    schema.add({"intensity", pcm::ScalarType::u16, 1, 1, 0, ""});
    pcm::Chunk chunk;
    chunk.points = 3;
    auto positions = std::make_shared<pcm::ChunkPositions>();
    positions->origin = {100, -200, 300};
    positions->narrow_xyz = {pcm::PageVector<std::uint32_t>{0, 1, 5}, {7, 0, 2}, {0, 0, 0}};
    chunk.positions = positions;
    auto intensity = std::make_shared<pcm::Column>(schema[0]);
    intensity->resize(3);
    intensity->as<std::uint16_t>()[0] = 1000;
    intensity->as<std::uint16_t>()[1] = 1000;
    intensity->as<std::uint16_t>()[2] = 1000;
    chunk.attributes = {intensity};
    pcm::Grid grid;
    grid.scale = {0.5, 0.5, 0.5};
    grid.offset = {1, 2, 3};
    const auto bytes = pcm::encode_chunk(chunk, schema, grid);
    std::string hex;
    for (const std::byte b : bytes) {
        static const char digits[] = "0123456789abcdef";
        hex += digits[static_cast<int>(b) >> 4];
        hex += digits[static_cast<int>(b) & 15];
    }
    EXPECT_EQ(hex,
              "425043310100000000000000000000000000000000000000ee000000030000009201000000000000000000000000e03f"
              "000000000000e03f000000000000e03f000000000000f03f000000000000004000000000000008406400000000000000"
              "38ffffffffffffff2c0100000000000069000000000000003fffffffffffffff2c010000000000000000000001000000"
              "ee00000000000000940000000000000040673f93e32a58b70401000000000000000000f03f0000000000000000090000"
              "00696e74656e73697479000000008201000000000000100000000000000027261d4df31dc4442e23683c7db462690100"
              "000042000000000000000000000003004801000000000000000000000000000000000000000000000000000000000000"
              "000000000000000000000000000000000100000042000000000000000000000003008700000000000000000000000000"
              "000000000000000000000000000000000000000000000000000000000000000000000000000010000000000000000000"
              "00000000000010000000e803000000000000");
}

}  // namespace
