// Chunks of version 3: the node they name, their segments, and reading some of these alone.

#include "pcm/bpc/bpc_file.h"
#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/commit_record.h"
#include "pcm/io/bpc/bpc_reader.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <cstring>
#include <fstream>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

Schema some_attributes()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, "raw"});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, ""});
    schema.add({"time", ScalarType::f64, 1, 1, 0, ""});
    schema.add({"same", ScalarType::f32, 2, 1, 0, ""});  // one value for all points
    return schema;
}

ChunkIdentity identity_of(const std::vector<std::uint32_t>& level_points, std::uint16_t first_level = 2)
{
    ChunkIdentity identity;
    identity.path = NodePath().child(1).child(0).child(1);
    identity.part = 3;
    identity.generation = 7;
    identity.first_level = first_level;
    identity.level_points = level_points;
    identity.spacing = 0.25;
    return identity;
}

Chunk walk(const Schema& schema, std::uint32_t points, bool wide, std::mt19937_64& random)
{
    Chunk chunk;
    chunk.points = points;
    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = {-1000000, 5, std::int64_t(1) << 40};
    positions->wide = wide;
    for (std::size_t a = 0; a < 3; ++a) {
        std::uint64_t at = 0;  // neighbours in the chunk are neighbours in space
        for (std::uint32_t i = 0; i < points; ++i) {
            if (wide)
                positions->wide_xyz[a].push_back(at << 30);
            else
                positions->narrow_xyz[a].push_back(static_cast<std::uint32_t>(at));
            at += random() % 9;
        }
    }
    chunk.positions = positions;
    for (const Attribute& attribute : schema) {
        auto column = std::make_shared<Column>(attribute);
        column->resize(points);
        for (std::size_t i = 0; i < column->bytes(); ++i)
            column->data()[i] =
                static_cast<std::byte>(attribute.name == "same" ? i % column->point_bytes() : random() % 50);
        chunk.attributes.push_back(column);
    }
    return chunk;
}

File written(const std::filesystem::path& path, const std::vector<std::byte>& bytes, std::size_t gap = 0)
{
    std::filesystem::remove(path);
    File file(path, File::Mode::create_new);
    if (gap) file.write_at(std::string(gap, 'x').data(), gap, 0);
    file.write_at(bytes.data(), bytes.size(), gap);
    return file;
}

// That point i of `a` is point j of `b`, in the columns that `a` has.
void expect_same_point(const Chunk& a, std::size_t i, const Chunk& b, std::size_t j)
{
    if (a.positions) ASSERT_EQ(a.positions->grid(i), b.positions->grid(j));
    for (std::size_t k = 0; k < a.attributes.size(); ++k) {
        if (!a.attributes[k]) continue;
        const std::size_t size = a.attributes[k]->point_bytes();
        ASSERT_EQ(std::memcmp(a.attributes[k]->data() + i * size, b.attributes[k]->data() + j * size, size), 0) << k;
    }
}

TEST(TreeChunk, ComesBackWithItsNode)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(1);
    const Schema schema = some_attributes();
    const Grid grid{{0.001, 0.002, 0.5}, {5e6, -3, 0}};
    for (const bool wide : {false, true})
        for (const std::vector<std::uint32_t>& levels :
             std::vector<std::vector<std::uint32_t>>{{1}, {127, 0, 1}, {4096}, {4097}, {1, 9000, 300}, {0, 12289, 0}}) {
            std::uint32_t points = 0;
            for (const std::uint32_t n : levels) points += n;
            const Chunk chunk = walk(schema, points, wide, random);
            const ChunkIdentity identity = identity_of(levels);
            const auto bytes = encode_chunk(chunk, schema, grid, identity);
            const File file = written(folder / "chunk", bytes, 777);
            const DecodedChunk back = read_chunk(file, 777, bytes.size(), 0, ColumnSet::all(schema));
            ASSERT_TRUE(back.header.identity);
            EXPECT_TRUE(*back.header.identity == identity);
            EXPECT_EQ(back.header.grid, grid);
            EXPECT_EQ(back.header.schema, schema);
            ASSERT_EQ(back.chunk.points, points);
            for (std::size_t i = 0; i < points; ++i) expect_same_point(back.chunk, i, chunk, i);
            EXPECT_EQ(encode_chunk(back.chunk, schema, grid, identity), bytes);
        }
}

// The rule of FORMAT.md in other words: as few segments per level as possible, all of nearly one size, none across
// levels.
TEST(TreeChunk, SegmentsAreEvenAndTight)
{
    std::mt19937_64 random(2);
    for (int round = 0; round < 30; ++round) {
        std::vector<std::uint32_t> levels(1 + random() % 5);
        std::uint32_t points = 0;
        for (auto& n : levels) points += n = static_cast<std::uint32_t>(random() % (random() % 2 ? 30000 : 300));
        if (points == 0) continue;
        const Chunk chunk = walk({}, points, round % 2, random);
        const auto bytes = encode_chunk(chunk, {}, Grid(), identity_of(levels));
        const BpcHeader header = decode_header(bytes.data(), bytes.size(), {});
        std::uint32_t next = 0;
        std::size_t s = 0;
        for (std::size_t k = 0; k < levels.size(); ++k) {
            const std::size_t expected = (levels[k] + 4095) / 4096;
            const std::size_t before = s;
            for (std::uint32_t left = levels[k]; left > 0; ++s) {
                ASSERT_LT(s, header.segments.size());
                const BpcSegment& segment = header.segments[s];
                EXPECT_EQ(segment.first, next);
                EXPECT_EQ(segment.level, 2 + k);
                ASSERT_LE(segment.count, left);
                EXPECT_LE(segment.count, 4096u);
                if (segment.count < left) EXPECT_EQ(segment.count % 128, 0u);
                Box3i box;
                for (std::uint32_t i = 0; i < segment.count; ++i) box.extend(chunk.positions->grid(next + i));
                EXPECT_EQ(segment.box, box);
                next += segment.count;
                left -= segment.count;
            }
            EXPECT_EQ(s - before, expected);
        }
        EXPECT_EQ(s, header.segments.size());
        EXPECT_EQ(next, points);
    }
}

TEST(TreeChunk, APartIsTheFilteredWhole)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(3);
    const Schema schema = some_attributes();
    for (const bool wide : {false, true}) {
        const std::vector<std::uint32_t> levels{50, 0, 9000, 17000, 4097};
        std::uint32_t points = 0;
        for (const std::uint32_t n : levels) points += n;
        const Chunk chunk = walk(schema, points, wide, random);
        const auto bytes = encode_chunk(chunk, schema, Grid(), identity_of(levels));
        const BpcHeader header = decode_header(bytes.data(), bytes.size(), {});
        const File file = written(folder / "chunk", bytes, 99);
        for (int round = 0; round < 100; ++round) {
            Box3i box;
            for (int corner = 0; corner < 2; ++corner) box.extend(chunk.positions->grid(random() % points));
            const auto deepest = static_cast<std::uint16_t>(random() % 9);
            const auto wanted = [&](const Box3i& b, std::uint16_t level) {
                for (std::size_t a = 0; a < 3; ++a)
                    if (b.min[a] > box.max[a] || b.max[a] < box.min[a]) return false;
                return level <= deepest;
            };
            ColumnSet columns;
            columns.positions = random() & 1;
            for (std::size_t i = 0; i < schema.size(); ++i) columns.attributes.set(i, random() & 1);
            const DecodedPart part = read_chunk_part(file, 99, bytes.size(), header.header_bytes, columns, wanted);
            std::size_t k = 0, at = 0;
            for (std::uint32_t s = 0; s < header.segments.size(); ++s) {
                if (!wanted(header.segments[s].box, header.segments[s].level)) continue;
                ASSERT_LT(k, part.kept.size());
                EXPECT_EQ(part.kept[k++], s);
                for (std::uint32_t i = 0; i < header.segments[s].count; ++i)
                    expect_same_point(part.chunk, at++, chunk, header.segments[s].first + i);
            }
            EXPECT_EQ(k, part.kept.size());
            EXPECT_EQ(part.chunk.points, at);
            EXPECT_EQ(part.chunk.positions != nullptr, columns.positions);
            for (std::size_t i = 0; i < schema.size(); ++i)
                EXPECT_EQ(part.chunk.attributes[i] != nullptr, columns.attributes.test(i));
            // Every point of the box at these levels is among them.
            std::size_t inside = 0, found = 0;
            const std::size_t to = header.identity->first_level > deepest ? 0 : [&] {
                std::size_t n = 0;
                for (std::size_t l = 0; l < levels.size() && l + 2 <= deepest; ++l) n += levels[l];
                return n;
            }();
            for (std::size_t i = 0; i < to; ++i) inside += box.contains(chunk.positions->grid(i));
            if (part.chunk.positions)
                for (std::size_t i = 0; i < at; ++i) found += box.contains(part.chunk.positions->grid(i));
            if (columns.positions) EXPECT_EQ(found, inside);
        }
    }
}

TEST(TreeChunk, ASmallPartReadsLittle)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(4);
    const Schema schema = some_attributes();
    const std::vector<std::uint32_t> levels{1000, 100000};
    const auto bytes = encode_chunk(walk(schema, 101000, false, random), schema, Grid(), identity_of(levels, 0));
    const BpcHeader header = decode_header(bytes.data(), bytes.size(), {});
    EXPECT_LT(header.header_bytes * 1000, bytes.size() * 5);  // half a per cent
    const File file = written(folder / "chunk", bytes);
    const auto positions_of_level_0 =
        read_chunk_part(file, 0, bytes.size(), header.header_bytes, ColumnSet::only_positions(),
                        [](const Box3i&, std::uint16_t level) { return level == 0; });
    EXPECT_EQ(positions_of_level_0.chunk.points, 1000u);
    EXPECT_EQ(positions_of_level_0.bytes_read, header.header_bytes + header.positions.pieces[0].bytes);
    const auto nothing = read_chunk_part(file, 0, bytes.size(), header.header_bytes, ColumnSet::all(schema),
                                         [](const Box3i&, std::uint16_t) { return false; });
    EXPECT_EQ(nothing.chunk.points, 0u);
    EXPECT_EQ(nothing.bytes_read, header.header_bytes);
    // Damage is an error inside of what is read, and not outside.
    std::vector<std::byte> damaged = bytes;
    damaged[header.positions.pieces[9].offset] ^= std::byte(1);
    const File bad = written(folder / "bad", damaged);
    const auto level_0 = [](const Box3i&, std::uint16_t level) { return level == 0; };
    const auto level_1 = [](const Box3i&, std::uint16_t level) { return level == 1; };
    EXPECT_EQ(read_chunk_part(bad, 0, bytes.size(), header.header_bytes, ColumnSet::all(schema), level_0).chunk.points,
              1000u);
    EXPECT_THROW(read_chunk_part(bad, 0, bytes.size(), header.header_bytes, ColumnSet::all(schema), level_1), Error);
}

TEST(TreeChunk, AColumnOfOneValueTakesNoPlace)
{
    std::mt19937_64 random(5);
    Schema few, many;
    few.add({"a", ScalarType::u16, 1, 1, 0, ""});
    for (const Attribute& attribute : few) many.add(attribute);
    for (int i = 0; i < 10; ++i) many.add({"same" + std::to_string(i), ScalarType::u8, 1, 1, 0, ""});
    Chunk chunk = walk(few, 50000, false, random);
    const std::size_t without = encode_chunk(chunk, few, Grid(), identity_of({50000})).size();
    for (std::size_t i = 1; i < many.size(); ++i) {
        auto column = std::make_shared<Column>(many[i]);
        column->resize(50000);
        std::memset(column->data(), 7, column->bytes());
        chunk.attributes.push_back(column);
    }
    EXPECT_LE(encode_chunk(chunk, many, Grid(), identity_of({50000})).size(), without + 10 * 50);
}

TEST(TreeChunk, InvalidChunksAreNotEncoded)
{
    std::mt19937_64 random(6);
    const Chunk chunk = walk({}, 100, false, random);
    const auto refused = [&](const std::function<void(ChunkIdentity&)>& change) {
        ChunkIdentity identity = identity_of({60, 40});
        change(identity);
        EXPECT_THROW(encode_chunk(chunk, {}, Grid(), identity), Error);
    };
    EXPECT_NO_THROW(encode_chunk(chunk, {}, Grid(), identity_of({60, 40})));
    refused([](ChunkIdentity& i) { i.level_points[0] = 61; });
    refused([](ChunkIdentity& i) { i.level_points.clear(); });
    refused([](ChunkIdentity& i) { i.generation = 0; });
    refused([](ChunkIdentity& i) { i.spacing = -1; });
    refused([](ChunkIdentity& i) { i.first_level = 255; });
    refused([](ChunkIdentity& i) { i.path.depth = 129; });
    refused([](ChunkIdentity& i) { i.path.bits[0] |= 8; });
    Chunk shifted = chunk;
    auto positions = std::make_shared<ChunkPositions>(*chunk.positions);
    --positions->origin[1];
    for (auto& v : positions->narrow_xyz[1]) v += 5;
    shifted.positions = positions;
    EXPECT_THROW(encode_chunk(shifted, {}, Grid(), identity_of({60, 40})), Error);
}

// Every byte of a chunk, tombstones among them: a changed one is noticed, a missing one too.
TEST(TreeChunk, AnyChangedOrMissingByteIsRefused)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(7);
    const Schema schema = some_attributes();
    for (const std::uint32_t points : {0u, 300u}) {
        const ChunkIdentity identity = points ? identity_of({100, 200}) : identity_of({});
        const auto bytes =
            encode_chunk(points ? walk(schema, points, false, random) : Chunk(), schema, Grid(), identity);
        const auto read = [&](const File& file, std::size_t length) {
            read_chunk(file, 0, length, 0, ColumnSet::all(schema));
        };
        for (std::size_t at = 0; at < bytes.size(); ++at) {
            std::vector<std::byte> damaged = bytes;
            damaged[at] ^= static_cast<std::byte>(1 + random() % 255);
            EXPECT_THROW(read(written(folder / "chunk", damaged), bytes.size()), Error) << at;
        }
        for (std::size_t length = 0; length < bytes.size(); length += points ? 7 : 1) {
            const File file =
                written(folder / "chunk", {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)});
            EXPECT_THROW(read(file, bytes.size()), Error) << length;
            EXPECT_THROW(read(file, length), Error) << length;
        }
    }
}

// A header with a matching checksum and other bytes than were written: an error, or a valid chunk; no crash, and
// no point outside of its segment's box.
TEST(TreeChunk, AnInvalidHeaderIsRefused)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(8);
    const Schema schema = some_attributes();
    const auto bytes = encode_chunk(walk(schema, 700, false, random), schema, Grid(), identity_of({100, 600}));
    const std::size_t header_bytes = decode_header(bytes.data(), bytes.size(), {}).header_bytes;
    std::size_t refused = 0;
    for (std::size_t at = 0; at + 8 < header_bytes; ++at)
        for (const unsigned change : {1u, 128u, 255u}) {
            std::vector<std::byte> damaged = bytes;
            damaged[at] ^= static_cast<std::byte>(change);
            const std::uint64_t sum = checksum(damaged.data(), header_bytes - 8);
            std::memcpy(damaged.data() + header_bytes - 8, &sum, 8);
            const File file = written(folder / "chunk", damaged);
            try {
                const DecodedPart part = read_chunk_part(file, 0, bytes.size(), 0, ColumnSet::all(schema),
                                                         [](const Box3i&, std::uint16_t) { return true; });
                for (const std::uint32_t s : part.kept) {
                    const BpcSegment& segment = part.header.segments[s];
                    for (std::uint32_t i = 0; i < segment.count; ++i)
                        ASSERT_TRUE(segment.box.contains(part.chunk.positions->grid(segment.first + i)));
                }
            } catch (const Error&) {
                ++refused;
            }
        }
    EXPECT_GT(refused, header_bytes);
}

// A data file of a tree is a cloud: tombstones and commit records in it are passed over.
TEST(TreeChunk, ADataFileIsACloud)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(9);
    const Schema schema = some_attributes();
    std::vector<std::byte> all;
    const auto append = [&](const std::vector<std::byte>& bytes) { all.insert(all.end(), bytes.begin(), bytes.end()); };
    CommitRecord commit;
    commit.data_files = {{123, 1}, {0, 2}};
    const auto tombstone = encode_chunk(Chunk(), schema, Grid(), identity_of({}));
    append(tombstone);
    append(encode_chunk(walk(schema, 500, false, random), schema, Grid(), identity_of({500})));
    append(encode_commit(commit));
    append(tombstone);
    append(encode_chunk(walk(schema, 300, false, random), schema, Grid(), identity_of({300})));
    append(encode_commit(commit));
    written(folder / "data.bpc", all);
    const BpcFile file(folder / "data.bpc");
    EXPECT_EQ(file.cloud().points, 800u);
    EXPECT_EQ(file.cloud().chunks, 2u);
    const ChunkPlace first = file.find(499), second = file.find(500);
    EXPECT_EQ(file.read(first, ColumnSet::all(schema)).chunk.points, 500u);
    EXPECT_EQ(file.read(second, ColumnSet::all(schema)).chunk.points, 300u);
    EXPECT_EQ(file.after(first, file.header(first)).offset, second.offset);
    EXPECT_EQ(file.after(second, file.header(second)).offset, all.size());
    const auto reader = open_bpc(folder / "data.bpc");
    PointBatch batch;
    std::size_t points = 0;
    while (reader->read(batch, 130)) points += batch.size;
    EXPECT_EQ(points, 800u);
}

TEST(CommitRecord, ComesBackAndNoByteOfItCanChange)
{
    const TemporaryFolder folder;
    CommitRecord record;
    record.generation = 5;
    record.coverage_kept = false;
    record.points = 1234567890123;
    record.content_hash = 77;
    record.parts = 3;
    record.chunks = 400;
    record.data_files = {{1000, 1}, {0, 3}, {7, 5}};
    const auto bytes = encode_commit(record);
    EXPECT_EQ(bytes.size(), commit_bytes(3));
    std::uint64_t size = 0;
    {
        const File file = written(folder / "commit", bytes, 5);
        const auto back = read_commit(file, 5, bytes.size(), size);
        ASSERT_TRUE(back);
        EXPECT_EQ(size, bytes.size());
        EXPECT_EQ(encode_commit(*back), bytes);
        EXPECT_EQ(back->data_files, record.data_files);
        EXPECT_FALSE(back->coverage_kept);
        EXPECT_THROW(read_commit(file, 5, bytes.size() - 1, size), Error);
    }
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        auto damaged = bytes;
        damaged[at] ^= std::byte(0x41);
        const File file = written(folder / "commit", damaged);
        if (at < 4)
            EXPECT_FALSE(read_commit(file, 0, bytes.size(), size));
        else
            EXPECT_THROW(read_commit(file, 0, bytes.size(), size), Error) << at;
    }
}

// As FORMAT.md lays it out. If this test fails, the format has changed: give it a new version.
TEST(TreeChunk, FrozenBytes)
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"class", ScalarType::u8, 1, 1, 0, ""});
    Chunk chunk;
    chunk.points = 3;
    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = {100, -200, 300};
    positions->narrow_xyz = {PageVector<std::uint32_t>{0, 1, 5}, {7, 0, 2}, {0, 0, 0}};
    chunk.positions = positions;
    auto intensity = std::make_shared<Column>(schema[0]), kind = std::make_shared<Column>(schema[1]);
    intensity->resize(3);
    kind->resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
        intensity->as<std::uint16_t>()[i] = static_cast<std::uint16_t>(1000 + i);
        kind->as<std::uint8_t>()[i] = 6;
    }
    chunk.attributes = {intensity, kind};
    const auto bytes = encode_chunk(chunk, schema, {{0.5, 0.5, 0.5}, {1, 2, 3}}, identity_of({1, 2}));
    EXPECT_EQ(bytes.size(), 540u);
    EXPECT_EQ(checksum(bytes.data(), bytes.size()), 11724136958126804642u);
    const auto tombstone = encode_chunk(Chunk(), schema, {{0.5, 0.5, 0.5}, {1, 2, 3}}, identity_of({}));
    EXPECT_EQ(tombstone.size(), 246u);
    EXPECT_EQ(checksum(tombstone.data(), tombstone.size()), 976617511482488397u);
    CommitRecord record;
    record.data_files = {{100, 1}};
    const auto commit = encode_commit(record);
    EXPECT_EQ(commit.size(), 64u);
    EXPECT_EQ(checksum(commit.data(), commit.size()), 14566760399625808554u);
}

}  // namespace
