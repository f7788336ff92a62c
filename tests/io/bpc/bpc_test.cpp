#include "tests/io/bpc_clouds.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/cloud_block.h"
#include "pcm/io/las/las_writer.h"

namespace pcm::test {
namespace {

std::string text(const std::vector<std::byte>& bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::size_t files_in(const std::filesystem::path& folder)
{
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

void expect_same_info(const FileInfo& a, const FileInfo& b)
{
    EXPECT_EQ(a.schema, b.schema);
    EXPECT_EQ(a.position_type, b.position_type);
    EXPECT_EQ(a.grid, b.grid);
    EXPECT_EQ(a.metadata, b.metadata);
    EXPECT_TRUE(b.notes.empty());
}

TEST(Bpc, WhatIsWrittenIsReadBitForBit)
{
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    for (int round = 0; round < 60; ++round) {
        const FileInfo info = random_cloud_info(random, round % 2);
        const PointBatch points = random_points(random, info, round % 7 == 0 ? 0 : random() % 3000);
        const auto path = folder / "a.bpc";
        write_cloud(path, info, points, 1 + random() % 700);
        const Whole whole = read_whole(path, 1 + random() % 700);
        expect_same_info(info, whole.info);
        EXPECT_TRUE(same_bits(points, whole.points)) << "round " << round;
    }
    EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(Bpc, ManyChunksAndSeeking)
{
    TemporaryFolder folder;
    std::mt19937_64 random(2);
    for (const bool gridded : {true, false}) {
        FileInfo info = random_cloud_info(random, gridded);
        info.schema.add({"number", ScalarType::u32, 1, 1, 0, ""});
        PointBatch points = random_points(random, info, 250001);
        for (std::uint32_t i = 0; i < points.size; ++i) points.attributes.back().as<std::uint32_t>()[i] = i;
        const auto path = folder / "a.bpc";
        write_cloud(path, info, points);
        const auto reader = open_reader(path);
        EXPECT_EQ(reader->info().format, "BPC, 3 chunks");
        ASSERT_TRUE(reader->seekable());
        PointBatch batch;
        for (int round = 0; round < 40; ++round) {
            const std::size_t at = round % 4 ? random() % points.size : 100000 * (random() % 3);
            const std::size_t count = 1 + random() % 2000;
            reader->seek(at);
            ASSERT_TRUE(reader->read(batch, count));
            ASSERT_LE(batch.size, count);
            ASSERT_TRUE(same_bits(batch, part_of(points, info.schema, at, batch.size)));
        }
        reader->seek(points.size);
        EXPECT_FALSE(reader->read(batch, 10));
        EXPECT_TRUE(same_bits(points, read_whole(path).points));
    }
}

// Any number of threads: the same bytes, the same points, the same error at the same point.
TEST(Bpc, ThreadsChangeNothing)
{
    TemporaryFolder folder;
    std::mt19937_64 random(10);
    const FileInfo info = random_cloud_info(random, true);
    const PointBatch points = random_points(random, info, 1050000);
    write_cloud(folder / "one.bpc", info, points);
    WriteOptions writing;
    writing.threads = 4;
    const auto writer = create_writer(folder / "four.bpc", info, writing);
    writer->write(points);
    writer->finish();
    std::string bytes = read_bytes(folder / "one.bpc");
    EXPECT_TRUE(read_bytes(folder / "four.bpc") == bytes);

    ReadOptions reading;
    reading.threads = 3;
    const auto reader = open_reader(folder / "one.bpc", reading);
    EXPECT_TRUE(same_bits(read_whole(*reader).points, points));
    PointBatch batch;
    for (const std::size_t at : {700001, 5, 100000, 1049999}) {
        reader->seek(at);
        ASSERT_TRUE(reader->read(batch, 1000));
        EXPECT_TRUE(same_bits(batch, part_of(points, info.schema, at, batch.size)));
    }

    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    write_file(folder / "one.bpc", bytes);
    const auto read_until_error = [&](unsigned threads) {
        reading.threads = threads;
        const auto damaged = open_reader(folder / "one.bpc", reading);
        std::size_t read = 0;
        const Error error = error_of([&] {
            while (damaged->read(batch, 1u << 20)) read += batch.size;
        });
        return std::to_string(read) + error.what();
    };
    EXPECT_EQ(read_until_error(3), read_until_error(1));
}

TEST(Bpc, TheBoxIsThatOfThePoints)
{
    TemporaryFolder folder;
    FileInfo info;
    PointBatch points;
    points.reset(info.schema, false, 3);
    points.xyz = {std::vector<double>{1, -2, 3}, {0.5, 0.25, 1e9}, {0, 0, 0}};
    write_cloud(folder / "a.bpc", info, points);
    EXPECT_EQ(*open_reader(folder / "a.bpc")->info().promised_box, (Box3d{{-2, 0.25, 0}, {3, 1e9, 0}}));
    points.xyz[2][1] = std::numeric_limits<double>::quiet_NaN();
    write_cloud(folder / "a.bpc", info, points);
    EXPECT_FALSE(open_reader(folder / "a.bpc")->info().promised_box) << "no box holds NaN";
}

// Chunks without a cloud block, as a tree's data files are.
TEST(Bpc, BareChunksAreACloud)
{
    TemporaryFolder folder;
    std::mt19937_64 random(3);
    for (const bool gridded : {true, false}) {
        FileInfo info = random_cloud_info(random, gridded);
        info.metadata.clear();
        info.position_type = gridded ? ScalarType::i32 : ScalarType::f64;
        const PointBatch points = random_points(random, info, 1000);
        std::string bytes;
        for (std::size_t done = 0; done < points.size; done += 100)
            bytes += text(encode_batch(part_of(points, info.schema, done, 100), info.schema, info.grid));
        const Whole whole = read_whole(write_file(folder / "no extension", bytes));
        EXPECT_EQ(whole.info.format, "BPC, 10 chunks");
        expect_same_info(info, whole.info);
        EXPECT_TRUE(same_bits(points, whole.points));

        const Error rest = error_of([&] { open_reader(write_file(folder / "a.bpc", bytes + "more")); });
        EXPECT_EQ(rest.code(), ErrorCode::corrupt);
        EXPECT_TRUE(mentions(rest.what(), "chunk at byte " + std::to_string(bytes.size()))) << rest.what();
    }
}

// With two grids, or integers beyond 32 bits, positions are doubles of the same value.
TEST(Bpc, BareChunksOnSeveralGridsAreDoubles)
{
    TemporaryFolder folder;
    std::mt19937_64 random(4);
    const FileInfo info = random_cloud_info(random, true);
    const PointBatch points = random_points(random, info, 100);
    const Grid other{{0.5, 0.25, 0.125}, {1, 2, 3}};
    const auto first = encode_batch(points, info.schema, info.grid), second = encode_batch(points, info.schema, other);
    const Whole two = read_whole(write_file(folder / "a.bpc", text(first) + text(second)));
    EXPECT_FALSE(two.info.grid);
    ASSERT_EQ(two.points.size, 200u);
    for (std::size_t i = 0; i < 200; ++i)
        for (std::size_t a = 0; a < 3; ++a)
            ASSERT_EQ(two.points.xyz[a][i], (i < 100 ? *info.grid : other).to_source(points.grid_xyz[a][i % 100], a));

    Chunk wide;
    wide.points = 2;
    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = {std::int64_t{1} << 40, 0, -5};
    positions->wide = true;
    positions->wide_xyz = {PageVector<std::uint64_t>{0, 7}, {std::uint64_t{1} << 50, 0}, {0, 0}};
    wide.positions = positions;
    const Whole far = read_whole(write_file(folder / "b.bpc", text(encode_chunk(wide, {}, other))));
    EXPECT_FALSE(far.info.grid);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(far.position(i), other.to_source(positions->grid(i)));

    const auto strange = encode_batch(part_of(points, info.schema, 0, 1), info.schema, Grid{{0, 1, 1}, {0, 0, 0}});
    EXPECT_FALSE(read_whole(write_file(folder / "c.bpc", text(strange))).info.grid)
        << "a step of 0 does not make a grid";
}

TEST(Bpc, ChunksOfDifferentAttributesAreRefused)
{
    TemporaryFolder folder;
    std::mt19937_64 random(5);
    FileInfo info = random_cloud_info(random, true);
    const auto first = encode_batch(random_points(random, info, 10), info.schema, info.grid);
    info.schema.add({"another", ScalarType::u8, 1, 1, 0, ""});
    const auto second = encode_batch(random_points(random, info, 10), info.schema, info.grid);
    const Error error = error_of([&] { open_reader(write_file(folder / "a.bpc", text(first) + text(second))); });
    EXPECT_EQ(error.code(), ErrorCode::corrupt);
    EXPECT_TRUE(mentions(error.what(), "chunk 1 at byte " + std::to_string(first.size()))) << error.what();
}

// A constant column takes 16 bytes for any number of points: a small file must not fill the memory.
TEST(Bpc, AHugeChunkOfConstantsIsRefused)
{
    TemporaryFolder folder;
    FileInfo info;
    info.grid = Grid{};
    PointBatch points;
    points.reset(info.schema, true, 1);
    for (auto& axis : points.grid_xyz) axis[0] = 0;
    auto bytes = encode_batch(points, info.schema, info.grid);
    const std::uint32_t many = 4000000000u;
    std::memcpy(bytes.data() + 28, &many, 4);
    std::uint32_t header;
    std::memcpy(&header, bytes.data() + 24, 4);
    const std::uint64_t sum = checksum(bytes.data(), header - 8);
    std::memcpy(bytes.data() + header - 8, &sum, 8);
    const Error error = error_of([&] { open_reader(write_file(folder / "a.bpc", text(bytes))); });
    EXPECT_EQ(error.code(), ErrorCode::unsupported);
    EXPECT_TRUE(mentions(error.what(), "4000000000 points")) << error.what();
}

// Truncated at every length, with and without a cloud block.
TEST(Bpc, TruncationIsRefused)
{
    TemporaryFolder folder;
    std::mt19937_64 random(6);
    FileInfo info = random_cloud_info(random, false);
    info.metadata = {{"a", {std::byte{1}, std::byte{2}}}};
    const PointBatch points = random_points(random, info, 20);
    write_cloud(folder / "a.bpc", info, points);
    const std::string whole = read_bytes(folder / "a.bpc");
    const std::string chunk = text(encode_batch(points, info.schema, info.grid));
    for (const std::string& bytes : {whole, chunk + chunk})
        for (std::size_t length = 0; length < bytes.size(); ++length) {
            if (length == chunk.size() && bytes.size() == 2 * length) continue;  // a whole chunk is a cloud
            const auto path = write_file(folder / "b.bpc", bytes.substr(0, length));
            const Error error = error_of([&] { read_whole(path); });
            EXPECT_TRUE(error.code() == ErrorCode::truncated || error.code() == ErrorCode::corrupt ||
                        (length < 8 && error.code() == ErrorCode::bad_format))
                << length << ": " << error.what();
            EXPECT_TRUE(mentions(error.what(), path.string())) << error.what();
        }
}

TEST(Bpc, AnyChangedByteIsRefused)
{
    TemporaryFolder folder;
    std::mt19937_64 random(7);
    FileInfo info = random_cloud_info(random, true);
    info.metadata = {{"a", {std::byte{1}, std::byte{2}}}};
    write_cloud(folder / "a.bpc", info, random_points(random, info, 20));
    const std::string whole = read_bytes(folder / "a.bpc");
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + random() % 255));
        const auto path = write_file(folder / "b.bpc", bytes);
        const Error error = error_of([&] { read_whole(path); });
        EXPECT_TRUE(mentions(error.what(), path.string())) << at << ": " << error.what();
    }
    const Error stray = error_of([&] { open_reader(write_file(folder / "b.bpc", whole + "x")); });
    EXPECT_TRUE(mentions(stray.what(), "stray bytes")) << stray.what();
}

// With corrected checksums, so that mutations reach the decoder: they are read or refused, nothing else.
TEST(Bpc, MutationsWithValidChecksums)
{
    TemporaryFolder folder;
    std::mt19937_64 random(8);
    std::vector<std::string> seeds;
    for (int i = 0; i < 6; ++i) {
        FileInfo info = random_cloud_info(random, i % 2);
        const PointBatch points = random_points(random, info, 5 + random() % 300);
        write_cloud(folder / "a.bpc", info, points);
        seeds.push_back(read_bytes(folder / "a.bpc"));
    }
    int read = 0, refused = 0;
    for (int round = 0; round < 6000; ++round) {
        std::string bytes = seeds[random() % seeds.size()];
        std::uint64_t block_bytes, table;
        std::memcpy(&block_bytes, &bytes[16], 8);
        std::memcpy(&table, &bytes[40], 8);
        const std::size_t chunk = static_cast<std::size_t>(block_bytes);
        std::uint32_t header_bytes;
        std::memcpy(&header_bytes, &bytes[chunk + 24], 4);
        // Parts followed by a checksum; the first column's is in the header.
        const std::size_t part = random() % 4;
        const std::size_t starts[] = {0, chunk, static_cast<std::size_t>(table), chunk + header_bytes};
        std::uint64_t column_bytes;
        std::memcpy(&column_bytes, &bytes[chunk + 152], 8);
        const std::size_t sizes[] = {chunk - 8, header_bytes - 8, bytes.size() - static_cast<std::size_t>(table) - 8,
                                     static_cast<std::size_t>(column_bytes)};
        static constexpr unsigned char favourites[] = {0, 1, 2, 0x7F, 0x80, 0xFF};
        for (std::size_t i = 0; i < 1 + random() % 3; ++i) {
            const std::size_t at = starts[part] + random() % sizes[part];
            const auto value = static_cast<char>(random() % 2 ? favourites[random() % 6] : random());
            for (std::size_t k = at; k < starts[part] + sizes[part] && k < at + (random() % 3 ? 1 : 8); ++k)
                bytes[k] = value;
        }
        const auto seal = [&](std::size_t from, std::size_t size, std::size_t at) {
            const std::uint64_t sum = checksum(bytes.data() + from, size);
            std::memcpy(&bytes[at], &sum, 8);
        };
        if (part == 3) seal(starts[3], sizes[3], chunk + 160);
        if (part == 3) seal(starts[1], sizes[1], chunk + header_bytes - 8);
        if (part != 3) seal(starts[part], sizes[part], starts[part] + sizes[part]);
        const auto path = write_file(folder / "b.bpc", bytes);
        try {
            const auto reader = open_reader(path);
            PointBatch batch;
            std::uint64_t points = 0;
            while (reader->read(batch, 1u << 30)) points += batch.size;
            ASSERT_EQ(points, reader->info().points);
            ++read;
        } catch (const Error& error) {
            ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(read, 300);
    EXPECT_GT(refused, 300);
}

TEST(Bpc, WhatTheWriterRefuses)
{
    TemporaryFolder folder;
    std::mt19937_64 random(9);
    FileInfo info = random_cloud_info(random, true);
    const PointBatch points = random_points(random, info, 10);
    FileInfo other = info;
    other.grid.reset();
    EXPECT_EQ(error_of([&] { create_writer(folder / "a.bpc", other)->write(points); }).code(),
              ErrorCode::invalid_argument);
    other = info;
    other.schema.add({"another", ScalarType::u8, 1, 1, 0, ""});
    EXPECT_EQ(error_of([&] { create_writer(folder / "a.bpc", other)->write(points); }).code(),
              ErrorCode::invalid_argument);
    other = info;
    other.grid->scale[1] = 0;
    EXPECT_EQ(error_of([&] { create_writer(folder / "a.bpc", other); }).code(), ErrorCode::invalid_argument);
    other = info;
    other.metadata = {{"large", std::vector<std::byte>(static_cast<std::size_t>(most_cloud_block_bytes))}};
    EXPECT_EQ(error_of([&] { create_writer(folder / "a.bpc", other); }).code(), ErrorCode::unsupported);
    create_writer(folder / "a.bpc", info)->write(points);  // never finished
    EXPECT_EQ(files_in(folder.path()), 0u);
}

// Version 1 of the block and the table, version 2 of a chunk, byte by byte, as FORMAT.md lays them out. If this fails,
// the format has changed: give it a new version.
TEST(Bpc, FrozenBytes)
{
    TemporaryFolder folder;
    FileInfo info;
    info.schema.add({"i", ScalarType::u8, 1, 1, 0, "d"});
    info.position_type = ScalarType::f64;
    info.metadata = {{"k", {std::byte{0xab}}}};
    PointBatch points;
    points.reset(info.schema, false, 2);
    points.xyz = {std::vector<double>{0.1, -0.3}, {0.0, -0.0}, {1.5, -1.25}};
    points.attributes[0].as<std::uint8_t>()[0] = points.attributes[0].as<std::uint8_t>()[1] = 9;
    write_cloud(folder / "a.bpc", info, points);
    const std::string found = read_bytes(folder / "a.bpc");

    const auto sealed = [](Bytes& bytes, std::size_t from) {
        bytes.put(checksum(bytes.data.data() + from, bytes.data.size() - from));
    };
    Bytes all;
    all.raw("BPCLOUD\n").put(1u).put(std::uint8_t{10}).put(std::uint8_t{0}).put(std::uint16_t{0});
    const std::uint64_t attribute = 1 + 4 + 8 + 8 + 5 + 5, block = 148 + attribute + 4 + (5 + 8 + 1) + 8;
    const std::uint64_t header = 168 + attribute + 24 + 8, sequence = 16;
    // x: -3, 1 of tenths, a difference of 4 = 1 << 2; y: bits, codes 0 and -1; z: 6, -5 quarters.
    const std::uint64_t x = 16 + 2 + 16 * 1, y = 16 + 2 + 16 * 1, z = 16 + 2 + 16 * 4, positions = x + y + z;
    const std::uint64_t chunk = header + positions + sequence;
    all.put(block).put(std::uint64_t{2}).put(std::uint64_t{1}).put(block + chunk);
    for (int i = 0; i < 3; ++i) all.put(1.0);
    for (int i = 0; i < 3; ++i) all.put(0.0);
    for (const double v : {-0.3, -0.0, -1.25, 0.1, 0.0, 1.5}) all.put(v);
    const auto put_attribute = [&] {
        all.put(std::uint8_t{2}).put(1u).put(1.0).put(0.0).put(1u).raw("i").put(1u).raw("d");
    };
    all.put(1u);
    put_attribute();
    all.put(1u).put(1u).raw("k").put(std::uint64_t{1}).raw("\xab");
    sealed(all, 0);
    EXPECT_EQ(all.data.size(), block);

    Bytes columns;
    const auto put_sequence = [&](int mode, std::uint64_t bytes, std::uint64_t low) {
        columns.put(static_cast<std::uint8_t>(mode)).put(std::uint8_t{0}).put(std::uint16_t{0});
        columns.put(static_cast<std::uint32_t>(bytes)).put(low);
    };
    const auto put_block = [&](unsigned width, unsigned shift, const char* bits) {
        columns.put(static_cast<std::uint8_t>(width)).put(static_cast<std::uint8_t>(shift));
        columns.text(bits, 16 * width);
    };
    put_sequence(1, x, 0);
    put_block(1, 2, "\x01");
    put_sequence(1, y, 0);
    put_block(1, 0, "\x01");
    put_sequence(1, z, 0);
    put_block(4, 0, "\x0b");
    EXPECT_EQ(columns.data.size(), positions);
    put_sequence(0, sequence, 9);

    all.raw("BPC1").put(std::uint16_t{2}).put(std::uint16_t{0}).put(std::uint64_t{0}).put(std::uint64_t{0});
    all.put(static_cast<std::uint32_t>(header)).put(2u).put(chunk);
    for (const double v : {10.0, 0.0, 4.0}) all.put(v);
    for (const double v : {0.0, 62.0, 0.0}) all.put(v);
    for (const int v : {-3, -1, -5, 1, 0, 6}) all.put(std::int64_t{v});
    all.put(0u).put(1u);
    all.put(header).put(positions).put(checksum(columns.data.data(), static_cast<std::size_t>(positions)));
    put_attribute();
    all.put(header + positions).put(sequence);
    all.put(checksum(columns.data.data() + positions, static_cast<std::size_t>(sequence)));
    sealed(all, static_cast<std::size_t>(block));
    all.raw(columns.data);
    EXPECT_EQ(all.data.size(), block + chunk);

    all.raw("BPCTABLE").put(std::uint64_t{2}).put(chunk);
    sealed(all, static_cast<std::size_t>(block + chunk));
    ASSERT_EQ(found.size(), all.data.size());
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], all.data[i]) << "byte " << i;
}

}  // namespace
}  // namespace pcm::test
