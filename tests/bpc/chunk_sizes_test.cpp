// Chunks of trees with the sizes of their points.

#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/layout.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <cstring>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr std::size_t has_at = 136;

Schema one_attribute()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    return schema;
}

ChunkIdentity identity_of(const std::vector<std::uint32_t>& level_points)
{
    ChunkIdentity identity;
    identity.path = NodePath().child(1).child(0).child(1);
    identity.part = 3;
    identity.generation = 7;
    identity.first_level = 2;
    identity.level_points = level_points;
    identity.spacing = 0.25;
    return identity;
}

std::shared_ptr<Column> sizes_of(std::uint32_t points, const std::function<std::uint8_t(std::size_t)>& size)
{
    const auto column = std::make_shared<Column>(attribute_of_sizes());
    column->resize(points);
    for (std::size_t i = 0; i < points; ++i) column->as<std::uint8_t>()[i] = size(i);
    return column;
}

Chunk chunk_of(std::uint32_t points, const std::shared_ptr<Column>& sizes)
{
    std::mt19937_64 random(points);
    Chunk chunk;
    chunk.points = points;
    const auto positions = std::make_shared<ChunkPositions>();
    positions->origin = {-1000, 5, 70};
    for (auto& axis : positions->narrow_xyz)
        for (std::uint32_t i = 0; i < points; ++i) axis.push_back(i ? static_cast<std::uint32_t>(random() % 5000) : 0);
    chunk.positions = positions;
    const auto intensity = std::make_shared<Column>(one_attribute()[0]);
    intensity->resize(points);
    for (std::size_t i = 0; i < points; ++i)
        intensity->as<std::uint16_t>()[i] = static_cast<std::uint16_t>(random() % 3000);
    chunk.attributes = {intensity};
    chunk.sizes = sizes;
    return chunk;
}

std::vector<std::byte> encoded(const Chunk& chunk, const std::vector<std::uint32_t>& levels)
{
    return encode_chunk(chunk, one_attribute(), Grid{{0.01, 0.01, 0.01}, {1, 2, 3}}, identity_of(levels));
}

class ChunkSizes : public testing::Test {
protected:
    File file_of(const std::vector<std::byte>& bytes) const
    {
        std::filesystem::remove(folder_ / "chunk");
        File file(folder_ / "chunk", File::Mode::create_new);
        file.write_at(bytes.data(), bytes.size(), 0);
        return file;
    }
    DecodedChunk read(const std::vector<std::byte>& bytes, const ColumnSet& columns) const
    {
        return read_chunk(file_of(bytes), 0, bytes.size(), 0, columns);
    }
    bool is_refused(const std::vector<std::byte>& bytes, const ColumnSet& columns) const
    {
        try {
            read(bytes, columns);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::corrupt) << error.what();
            return true;
        }
        return false;
    }
    static void seal(std::vector<std::byte>& bytes)
    {
        std::uint32_t header_bytes = 0;
        std::memcpy(&header_bytes, bytes.data() + bpc_layout::header_bytes_at, 4);
        const std::uint64_t sum = checksum(bytes.data(), header_bytes - 8);
        std::memcpy(bytes.data() + header_bytes - 8, &sum, 8);
    }

    const TemporaryFolder folder_;
    const Schema schema_ = one_attribute();
    const ColumnSet all_ = ColumnSet::all(schema_), whole_ = ColumnSet::whole(schema_);
};

TEST_F(ChunkSizes, ComeBack)
{
    std::mt19937_64 random(1);
    for (const std::vector<std::uint32_t>& levels :
         std::vector<std::vector<std::uint32_t>>{{1}, {127, 0, 1}, {4097}, {1, 9000, 300}}) {
        std::uint32_t points = 0;
        for (const std::uint32_t n : levels) points += n;
        const Chunk chunk =
            chunk_of(points, sizes_of(points, [&](std::size_t) { return static_cast<std::uint8_t>(random()); }));
        const auto bytes = encoded(chunk, levels);
        const DecodedChunk back = read(bytes, whole_);
        ASSERT_TRUE(back.header.sizes);
        ASSERT_TRUE(back.chunk.sizes);
        EXPECT_EQ(back.chunk.sizes->type(), ScalarType::u8);
        ASSERT_EQ(back.chunk.sizes->bytes(), points);
        EXPECT_EQ(std::memcmp(back.chunk.sizes->data(), chunk.sizes->data(), points), 0);
        EXPECT_TRUE(back.chunk.columns() == whole_);
        EXPECT_EQ(encoded(back.chunk, levels), bytes);
        EXPECT_EQ(back.header.schema, schema_);  // sizes are not an attribute

        ColumnSet only;
        only.positions = false;
        only.sizes = true;
        const DecodedChunk alone = read(bytes, only);
        EXPECT_EQ(std::memcmp(alone.chunk.sizes->data(), chunk.sizes->data(), points), 0);
        EXPECT_TRUE(alone.chunk.columns() == only);
        EXPECT_EQ(alone.chunk.bytes(), points);
    }
}

TEST_F(ChunkSizes, AreReadWhenAskedForAndWhereTheyAre)
{
    const Chunk with = chunk_of(500, sizes_of(500, [](std::size_t i) { return static_cast<std::uint8_t>(i % 7); }));
    EXPECT_EQ(read(encoded(with, {500}), all_).chunk.sizes, nullptr);
    Chunk without = with;
    without.sizes = nullptr;
    const DecodedChunk old = read(encoded(without, {500}), whole_);
    EXPECT_FALSE(old.header.sizes);
    EXPECT_EQ(old.chunk.sizes, nullptr);
    // What trees make of it: sizes that are not known, where they are asked for.
    Chunk chunk = old.chunk;
    add_missing_columns(chunk, schema_, all_);
    EXPECT_EQ(chunk.sizes, nullptr);
    add_missing_columns(chunk, schema_, whole_);
    ASSERT_TRUE(chunk.sizes);
    ASSERT_EQ(chunk.sizes->size(), 500u);
    for (std::size_t i = 0; i < 500; ++i) EXPECT_EQ(chunk.sizes->as<std::uint8_t>()[i], 0);
    // And existing ones stay.
    chunk.sizes = with.sizes;
    add_missing_columns(chunk, schema_, whole_);
    EXPECT_EQ(chunk.sizes, with.sizes);
}

TEST_F(ChunkSizes, APartIsTheFilteredWhole)
{
    const Chunk chunk = chunk_of(
        13000, sizes_of(13000, [](std::size_t i) { return static_cast<std::uint8_t>(i * 2654435761u >> 24); }));
    const auto bytes = encoded(chunk, {100, 9000, 3900});
    const File file = file_of(bytes);
    const BpcHeader header = decode_header(bytes.data(), bytes.size(), {});
    ASSERT_GT(header.segments.size(), 4u);
    for (std::size_t pick = 0; pick < header.segments.size(); ++pick)
        for (const bool positions : {false, true}) {
            ColumnSet columns;
            columns.positions = positions;
            columns.sizes = true;
            std::size_t s = 0;
            const DecodedPart part =
                read_chunk_part(file, 0, bytes.size(), header.header_bytes, columns,
                                [&](const Box3i&, std::uint16_t) { return s++ != pick && s % 2 == 1; });
            std::size_t at = 0;
            ASSERT_TRUE(part.chunk.sizes);
            for (const std::uint32_t k : part.kept)
                for (std::uint32_t i = 0; i < header.segments[k].count; ++i)
                    ASSERT_EQ(part.chunk.sizes->as<std::uint8_t>()[at++],
                              chunk.sizes->as<std::uint8_t>()[header.segments[k].first + i]);
            EXPECT_EQ(part.chunk.sizes->size(), at);
            EXPECT_EQ(part.chunk.points, at);
        }
}

TEST_F(ChunkSizes, EqualOnesTakeNoPlace)
{
    const Chunk chunk = chunk_of(5000, sizes_of(5000, [](std::size_t) { return std::uint8_t(9); }));
    Chunk without = chunk;
    without.sizes = nullptr;
    const auto bytes = encoded(chunk, {5000});
    EXPECT_EQ(bytes.size(), encoded(without, {5000}).size() + 9);  // a mode and a word
    const DecodedChunk back = read(bytes, whole_);
    EXPECT_EQ(back.header.sizes->constant, std::vector<std::uint64_t>{9});
    EXPECT_EQ(std::memcmp(back.chunk.sizes->data(), chunk.sizes->data(), 5000), 0);
    // A word that does not fit into a byte.
    auto large = bytes;
    const std::size_t word = back.header.header_bytes - 16;
    ASSERT_EQ(large[word], std::byte(9));
    large[word + 1] = std::byte(1);
    seal(large);
    EXPECT_TRUE(is_refused(large, all_));
}

TEST_F(ChunkSizes, ATombstoneHasNone)
{
    const auto bytes = encoded(Chunk(), {});
    Chunk empty;
    empty.sizes = sizes_of(0, [](std::size_t) { return std::uint8_t(1); });
    EXPECT_EQ(encoded(empty, {}), bytes);
    const DecodedChunk back = read(bytes, whole_);
    EXPECT_FALSE(back.header.sizes);
    EXPECT_EQ(back.chunk.points, 0u);
    auto with = bytes;
    with[has_at] |= static_cast<std::byte>(bpc_layout::has_sizes);
    seal(with);
    EXPECT_TRUE(is_refused(with, whole_));
}

// Damaged sizes are noticed where they are read, and do not matter where they are not.
TEST_F(ChunkSizes, AnyChangedOrMissingByteIsRefused)
{
    const Chunk chunk = chunk_of(300, sizes_of(300, [](std::size_t i) { return static_cast<std::uint8_t>(i * i); }));
    const auto bytes = encoded(chunk, {100, 200});
    const BpcHeader header = decode_header(bytes.data(), bytes.size(), {});
    ASSERT_TRUE(header.sizes);
    EXPECT_EQ(header.sizes->offset + header.sizes->bytes, bytes.size());  // they are the last column
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        auto damaged = bytes;
        damaged[at] ^= static_cast<std::byte>(1 + at % 255);
        if (at < 4 || at == 4 || at == 5) {  // another format
            EXPECT_THROW(read(damaged, whole_), Error) << at;
            continue;
        }
        EXPECT_TRUE(is_refused(damaged, whole_)) << at;
        EXPECT_EQ(is_refused(damaged, all_), at < header.sizes->offset) << at;
    }
    for (std::size_t length = header.header_bytes; length < bytes.size(); ++length)
        EXPECT_THROW(read({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}, whole_), Error);
}

TEST_F(ChunkSizes, WhatAChunkHasIsKnownOrRefused)
{
    const Chunk chunk = chunk_of(300, sizes_of(300, [](std::size_t i) { return static_cast<std::uint8_t>(i); }));
    const auto bytes = encoded(chunk, {300});
    EXPECT_EQ(bytes[has_at], std::byte(2));
    for (unsigned bit = 0; bit < 32; ++bit) {
        auto other = bytes;
        other[has_at + bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
        seal(other);
        EXPECT_TRUE(is_refused(other, all_)) << bit;
    }
    // An unknown mode of the sizes.
    const BpcHeader header = decode_header(bytes.data(), bytes.size(), {});
    auto other = bytes;
    const std::size_t mode = header.header_bytes - 8 - 12 * header.sizes->pieces.size() - 1;
    ASSERT_EQ(other[mode], std::byte(0));
    other[mode] = std::byte(2);
    seal(other);
    EXPECT_TRUE(is_refused(other, all_));
}

TEST_F(ChunkSizes, OfOtherPointsAreNotEncoded)
{
    Chunk chunk = chunk_of(100, sizes_of(99, [](std::size_t) { return std::uint8_t(1); }));
    EXPECT_THROW(encoded(chunk, {100}), Error);
    const auto words = std::make_shared<Column>(ScalarType::u16, 1);
    words->resize(100);
    chunk.sizes = words;
    EXPECT_THROW(encoded(chunk, {100}), Error);
}

TEST_F(ChunkSizes, AreInChunksOfTreesAlone)
{
    const Chunk with = chunk_of(200, sizes_of(200, [](std::size_t i) { return static_cast<std::uint8_t>(i); }));
    Chunk without = with;
    without.sizes = nullptr;
    const auto doubles = DoubleCodes::checked({100, 100, 100}, {0, 0, 0});
    ASSERT_TRUE(doubles);
    EXPECT_EQ(encode_chunk(with, schema_, Grid()), encode_chunk(without, schema_, Grid()));
    EXPECT_EQ(encode_chunk(with, schema_, *doubles), encode_chunk(without, schema_, *doubles));
    const DecodedChunk back = read(encode_chunk(with, schema_, Grid()), whole_);
    EXPECT_FALSE(back.header.sizes);
    EXPECT_EQ(back.chunk.sizes, nullptr);
    EXPECT_EQ(back.chunk.points, 200u);
}

// As FORMAT.md lays it out. If this test fails, the format has changed: give it a new version.
TEST_F(ChunkSizes, FrozenBytes)
{
    Chunk chunk;
    chunk.points = 3;
    const auto positions = std::make_shared<ChunkPositions>();
    positions->origin = {100, -200, 300};
    positions->narrow_xyz = {PageVector<std::uint32_t>{0, 1, 5}, {7, 0, 2}, {0, 0, 0}};
    chunk.positions = positions;
    const auto intensity = std::make_shared<Column>(schema_[0]);
    intensity->resize(3);
    for (std::size_t i = 0; i < 3; ++i) intensity->as<std::uint16_t>()[i] = static_cast<std::uint16_t>(1000 + i);
    chunk.attributes = {intensity};
    chunk.sizes = sizes_of(3, [](std::size_t i) { return static_cast<std::uint8_t>(20 + 3 * i); });
    const auto bytes = encoded(chunk, {1, 2});
    EXPECT_EQ(bytes.size(), 588u);
    EXPECT_EQ(checksum(bytes.data(), bytes.size()), 13421138057324898935u);
    chunk.sizes = sizes_of(3, [](std::size_t) { return std::uint8_t(20); });
    const auto equal = encoded(chunk, {1, 2});
    EXPECT_EQ(equal.size(), 506u);
    EXPECT_EQ(checksum(equal.data(), equal.size()), 448719864814958936u);
}

}  // namespace
