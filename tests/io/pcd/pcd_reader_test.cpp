#include "pcm/io/pcd/pcd_reader.h"

#include "tests/io/bytes.h"
#include "tests/io/lzf.h"

#include <array>
#include <cmath>
#include <limits>

namespace pcm::test {
namespace {

std::string pcd_header(const std::string& fields, const std::string& sizes, const std::string& kinds,
                       const std::string& counts, std::size_t points, const std::string& encoding)
{
    const std::string count = std::to_string(points);
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " +
           kinds + "\nCOUNT " + counts + "\nWIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count +
           "\nDATA " + encoding + "\n";
}

std::string xyz_header(std::size_t points, const std::string& encoding)
{
    return pcd_header("x y z", "4 4 4", "F F F", "1 1 1", points, encoding);
}

std::string compressed(const std::string& columns, std::size_t longest = 264)
{
    const std::string packed = lzf_compress(columns, longest);
    Bytes block;
    block.put(static_cast<std::uint32_t>(packed.size())).put(static_cast<std::uint32_t>(columns.size())).raw(packed);
    return block.data;
}

// The same cloud of every scalar type, padding and counts in the three encodings.
TEST(PcdReader, EveryTypeInEveryEncoding)
{
    constexpr std::size_t points = 700;
    const std::string fields = "_ a y b c _ d e z f g h i x rgba";
    const std::string sizes = "1 1 8 2 4 4 8 1 8 2 4 8 4 8 4", kinds = "U I F I I F I U F U U U F F U",
                      counts = "3 1 1 2 1 1 1 1 1 3 1 1 2 1 1";
    std::mt19937_64 random(7);
    std::vector<std::string> columns(15);  // as bytes, one per field
    std::string ascii;
    Bytes binary;
    std::array<std::vector<double>, 3> position;
    std::vector<double> b, i_values;
    std::vector<std::uint64_t> h;
    std::vector<std::uint32_t> colours;
    const auto put = [&](std::size_t field, auto value) {
        Bytes one;
        one.put(value);
        columns[field] += one.data;
        binary.raw(one.data);
        char text[64];
        if constexpr (std::is_floating_point_v<decltype(value)>)
            std::snprintf(text, sizeof text, "%.17g ", value);
        else
            std::snprintf(text, sizeof text, "%s ", std::to_string(value).c_str());
        ascii += text;
    };
    const auto real = [&] { return std::round(std::ldexp(static_cast<double>(random()), -50)) / 8; };
    for (std::size_t p = 0; p < points; ++p) {
        for (int k = 0; k < 3; ++k) put(0, static_cast<std::uint8_t>(9));
        put(1, static_cast<std::int8_t>(p));
        position[1].push_back(real());
        put(2, position[1].back());
        for (int k = 0; k < 2; ++k) {
            const auto value = static_cast<std::int16_t>(random());
            b.push_back(value);
            put(3, value);
        }
        put(4, static_cast<std::int32_t>(p) - 77);
        put(5, 1.5f);
        put(6, static_cast<std::int64_t>(-(1ll << 60) - static_cast<std::int64_t>(p)));
        put(7, static_cast<std::uint8_t>(random()));
        position[2].push_back(real());
        put(8, position[2].back());
        for (int k = 0; k < 3; ++k) put(9, static_cast<std::uint16_t>(p + static_cast<std::size_t>(k)));
        put(10, static_cast<std::uint32_t>(4000000000u + p));
        h.push_back(random());
        put(11, h.back());
        for (int k = 0; k < 2; ++k) {
            i_values.push_back(real());
            put(12, static_cast<float>(i_values.back()));
        }
        position[0].push_back(real() + 1e6);
        put(13, position[0].back());
        colours.push_back(static_cast<std::uint32_t>(random()));
        put(14, colours.back());
        ascii += '\n';
    }
    std::string all, without_padding;
    for (std::size_t f = 0; f < columns.size(); ++f) {
        all += columns[f];
        if (f != 0 && f != 5) without_padding += columns[f];
    }
    const auto header = [&](const char* encoding) {
        return pcd_header(fields, sizes, kinds, counts, points, encoding);
    };
    TemporaryFolder folder;
    for (const std::string& bytes :
         {header("ascii") + ascii, header("binary") + binary.data, header("binary_compressed") + compressed(all),
          header("binary_compressed") + compressed(without_padding, 9)}) {
        const Whole whole = read_whole(write_file(folder / "a.pcd", bytes), 777);
        SCOPED_TRACE(whole.info.format);
        EXPECT_TRUE(whole.info.notes.empty());
        EXPECT_EQ(whole.info.position_type, ScalarType::f64);
        const std::vector<std::pair<const char*, ScalarType>> expected = {
            {"a", ScalarType::i8},  {"b", ScalarType::i16},  {"c", ScalarType::i32},   {"d", ScalarType::i64},
            {"e", ScalarType::u8},  {"f", ScalarType::u16},  {"g", ScalarType::u32},   {"h", ScalarType::u64},
            {"i", ScalarType::f32}, {"rgb", ScalarType::u8}, {"alpha", ScalarType::u8}};
        ASSERT_EQ(whole.info.schema.size(), expected.size());
        for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_EQ(whole.info.schema[k].name, expected[k].first);
            EXPECT_EQ(whole.info.schema[k].type, expected[k].second);
        }
        ASSERT_EQ(whole.points.size, points);
        for (std::size_t p = 0; p < points; ++p) {
            for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_EQ(whole.points.xyz[axis][p], position[axis][p]);
            ASSERT_EQ(whole.value("a", p), static_cast<std::int8_t>(p));
            for (std::uint32_t k = 0; k < 2; ++k) {
                ASSERT_EQ(whole.value("b", p, k), b[2 * p + k]);
                ASSERT_EQ(whole.value("i", p, k), static_cast<float>(i_values[2 * p + k]));
            }
            ASSERT_EQ(whole.value("c", p), static_cast<double>(p) - 77);
            ASSERT_EQ(whole.raw<std::int64_t>("d", p), -(1ll << 60) - static_cast<std::int64_t>(p));
            ASSERT_EQ(whole.value("f", p, 2), static_cast<double>(static_cast<std::uint16_t>(p + 2)));
            ASSERT_EQ(whole.value("g", p), 4e9 + static_cast<double>(p));
            ASSERT_EQ(whole.raw<std::uint64_t>("h", p), h[p]);
            for (std::uint32_t k = 0; k < 3; ++k)
                ASSERT_EQ(whole.raw<std::uint8_t>("rgb", p, k), colours[p] >> (16 - 8 * k) & 255u);
            ASSERT_EQ(whole.raw<std::uint8_t>("alpha", p), colours[p] >> 24);
        }
    }

    const auto reader = open_reader(write_file(folder / "b.pcd", header("binary") + binary.data));
    ASSERT_TRUE(reader->seekable());
    PointBatch batch;
    for (const std::size_t start : {699, 0, 17, 700, 250}) {
        reader->seek(start);
        ASSERT_EQ(reader->read(batch, 10), start < points);
        for (std::size_t k = 0; k < batch.size; ++k) ASSERT_EQ(batch.xyz[2][k], position[2][start + k]);
    }
    EXPECT_EQ(error_of([&] { reader->seek(701); }).code(), ErrorCode::invalid_argument);
    EXPECT_FALSE(open_reader(write_file(folder / "c.pcd", header("ascii") + ascii))->seekable());
}

// Columns far longer than the stream's buffers, of data that compress well, little and not at all.
TEST(PcdReader, LongCompressedColumns)
{
    constexpr std::size_t points = 20000;
    std::mt19937_64 random(9);
    Bytes x, y, z;
    for (std::size_t i = 0; i < points; ++i) {
        x.put(random() % 50 ? 1.5f : 2.5f);
        y.put(static_cast<float>(i % 1000));
        z.put(static_cast<float>(random() % 1000000));
    }
    // The greedy compressor is slow on incompressible data: z is stored as literals.
    const std::string packed = lzf_compress(x.data + y.data) + lzf_compress(z.data, 0);
    Bytes block;
    block.put(static_cast<std::uint32_t>(packed.size())).put(static_cast<std::uint32_t>(points * 12)).raw(packed);
    TemporaryFolder folder;
    const Whole whole = read_whole(write_file(folder / "a.pcd", xyz_header(points, "binary_compressed") + block.data));
    ASSERT_EQ(whole.points.size, points);
    const std::string columns[3] = {x.data, y.data, z.data};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < points; ++i) {
            float value = 0;
            std::memcpy(&value, columns[axis].data() + 4 * i, 4);
            ASSERT_EQ(whole.points.xyz[axis][i], value);
        }
}

TEST(PcdReader, PackedColours)
{
    TemporaryFolder folder;
    const auto read = [&](const std::string& name, const std::string& kind, const std::string& text) {
        return read_whole(write_file(
            folder / "a.pcd",
            pcd_header("x y z " + name, "4 4 4 4", "F F F " + kind, "1 1 1 1", 1, "ascii") + "0 0 0 " + text + "\n"));
    };
    const auto expect = [&](const Whole& whole, int red, int green, int blue) {
        EXPECT_EQ(whole.value("rgb", 0, 0), red);
        EXPECT_EQ(whole.value("rgb", 0, 1), green);
        EXPECT_EQ(whole.value("rgb", 0, 2), blue);
    };
    expect(read("rgb", "U", "4278190337"), 0, 1, 1);
    EXPECT_FALSE(read("rgb", "U", "4278255873").info.schema.find("alpha"));
    expect(read("rgba", "U", "4278190337"), 0, 1, 1);
    EXPECT_EQ(read("rgba", "U", "4278255873").value("alpha", 0), 255);
    expect(read("rgb", "I", "-16711423"), 1, 1, 1);
    expect(read("rgb", "F", "9.219563e-41"), 1, 1, 1);         // the bits 0x010101
    expect(read("rgb", "F", "2.3509886e-38"), 255, 255, 255);  // 0xFFFFFF
    expect(read("rgb", "F", "4.2108e+06"), 64, 64, 112);       // as the first programs wrote 0x404070
    expect(read("rgb", "F", "16777215"), 255, 255, 255);       // white, as the first programs wrote it
    expect(read("rgb", "F", "1.6777215e+07"), 255, 255, 255);
    expect(read("rgb", "F", "16777216"), 0x80, 0, 0);  // beyond any colour: bits, 0x4B800000
    expect(read("rgb", "F", "1"), 0, 0, 1);
    expect(read("rgb", "U", "16777215"), 255, 255, 255);
    expect(read("rgba", "U", "4294967295"), 255, 255, 255);
    EXPECT_EQ(read("rgba", "U", "4294967295").value("alpha", 0), 255);
    expect(read("rgb", "F", "0"), 0, 0, 0);
    expect(read("RGB", "U", "66051"), 1, 2, 3);
    const Error error = error_of([&] { read("rgb", "U", "99999999999"); });
    EXPECT_TRUE(mentions(error.what(), "line 12") && mentions(error.what(), "99999999999")) << error.what();

    Bytes bytes;  // a NaN that carries a colour
    bytes.raw(pcd_header("rgb x y z", "4 4 4 4", "F F F F", "1 1 1 1", 1, "binary")).put(0xFFC01234u);
    bytes.put(1.f).put(2.f).put(3.f);
    const Whole whole = read_whole(write_file(folder / "b.pcd", bytes.data));
    expect(whole, 0xC0, 0x12, 0x34);
    EXPECT_EQ(whole.position(0), (Vec3d{1, 2, 3}));
}

TEST(PcdReader, GroupsAndNames)
{
    TemporaryFolder folder;
    const auto read = [&](const std::string& fields, const std::string& sizes, const std::string& kinds,
                          const std::string& counts, const std::string& line) {
        return read_whole(
            write_file(folder / "a.pcd", pcd_header(fields, sizes, kinds, counts, 1, "ascii") + line + "\n"));
    };
    const Whole pdal = read("X Y Z Red GpsTime Blue ReturnNumber Green Custom", "8 8 8 2 8 2 1 2 4",
                            "F F F U F U U U F", "1 1 1 1 1 1 1 1 1", "1 2 3 10 4.5 30 6 20 8");
    ASSERT_EQ(pdal.info.schema.size(), 4u);
    EXPECT_EQ(pdal.info.schema[0], (Attribute{"rgb", ScalarType::u16, 3, 1, 0, {}}));
    EXPECT_EQ(pdal.value("rgb", 0, 1), 20);
    EXPECT_EQ(pdal.value("gps_time", 0), 4.5);
    EXPECT_EQ(pdal.value("return_number", 0), 6);
    EXPECT_EQ(pdal.value("Custom", 0), 8);

    const Whole normals = read("normal_z x y z curvature normal_x normal_y", "4 4 4 4 4 4 4", "F F F F F F F",
                               "1 1 1 1 1 1 1", "3 0 0 0 7 1 2");
    EXPECT_EQ(normals.info.schema[0].name, "normal");
    for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(normals.value("normal", 0, c), c + 1);
    EXPECT_EQ(normals.value("curvature", 0), 7);

    const Whole mixed = read("x y z r g b normal rgb rgb nx ny nz nx", "4 4 4 1 2 1 4 4 4 4 4 4 4",
                             "F F F U U U F U U F F F F", "1 1 1 1 1 1 1 1 1 1 1 1 1", "0 0 0 1 2 3 4 5 6 7 8 9 10");
    for (const char* name : {"r", "g", "b", "normal_scalar", "rgb_scalar", "nx", "ny", "nz", "nx_2"})
        EXPECT_TRUE(mixed.info.schema.find(name)) << name;
    EXPECT_EQ(mixed.value("rgb", 0, 2), 5);
    EXPECT_EQ(mixed.value("rgb_scalar", 0), 6);

    const Whole triple = read("x y z rgb normal", "4 4 4 1 4", "F F F U F", "1 1 1 3 3", "0 0 0 1 2 3 4 5 6");
    EXPECT_EQ(triple.value("rgb", 0, 1), 2);
    EXPECT_EQ(triple.value("normal", 0, 2), 6);
}

TEST(PcdReader, HeadersOfOldVersions)
{
    TemporaryFolder folder;
    // .5: nothing but columns, all single precision; carriage returns; numbers between commas.
    const Whole old = read_whole(write_file(
        folder / "a.pcd", "# comment\r\nCOLUMNS x y z w\r\nPOINTS 2\r\nDATA ascii\r\n1, 2,3,4\r\n\r\n5\t6 7,,8\r\n"));
    EXPECT_EQ(old.info.position_type, ScalarType::f32);
    EXPECT_EQ(old.position(1), (Vec3d{5, 6, 7}));
    EXPECT_EQ(old.value("w", 1), 8);

    const Whole sized = read_whole(write_file(folder / "a.pcd",
                                              "VERSION .6\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 2\nHEIGHT "
                                              "3\nDATA ascii\n0 0 0\n0 0 0\n0 0 0\nnan nan nan\n0 0 0\n0 0 1e300\n"));
    EXPECT_EQ(sized.points.size, 6u);
    EXPECT_EQ(sized.info.format, "PCD .6 ascii");
    EXPECT_TRUE(any_mentions(sized.info.notes, "2 x 3"));
    EXPECT_TRUE(std::isnan(sized.position(3)[0]));
    EXPECT_EQ(sized.position(5)[2], 1e300);

    const FileInfo view = open_reader(write_file(folder / "a.pcd",
                                                 "VERSION .7\nFIELDS x y z\nWIDTH 0\nVIEWPOINT 1 2 "
                                                 "3 0 1 0 0\nPOINTS 0\nDATA ascii"))
                              ->info();
    ASSERT_EQ(view.metadata.size(), 1u);
    EXPECT_EQ(view.metadata[0].key, "pcd.viewpoint");
    EXPECT_EQ(view.metadata[0].value.size(), 13u);
}

TEST(PcdReader, WhatIsIgnoredIsNoted)
{
    TemporaryFolder folder;
    const auto notes = [&](const std::string& bytes) {
        const auto reader = open_reader(write_file(folder / "a.pcd", bytes));
        read_whole(*reader);
        return reader->info().notes;
    };
    EXPECT_TRUE(notes(xyz_header(1, "ascii") + "1 2 3\n").empty());
    EXPECT_TRUE(any_mentions(notes(xyz_header(1, "ascii") + "1 2 3\n\n4 5 6\n"), "line 14"));
    EXPECT_TRUE(any_mentions(notes(xyz_header(1, "binary") + "0123456789ab....."), "5 bytes"));
    EXPECT_TRUE(any_mentions(notes(xyz_header(1, "binary_compressed") + compressed("0123456789ab") + "."), "1 byte"));
    EXPECT_TRUE(any_mentions(notes("FIELDS x y z\nWIDTH 3\nHEIGHT 2\nPOINTS 1\nDATA ascii\n1 2 3\n"), "WIDTH 3"));
    EXPECT_TRUE(any_mentions(notes("VERSION 9\nFIELDS x y z\nPOINTS 1\nDATA ascii\n1 2 3\n"), "'9'"));
    EXPECT_TRUE(any_mentions(notes("VERSION .7\nTIME 3\nFIELDS x y z\nPOINTS 1\nDATA ascii\n1 2 3\n"), "1 lines"));
}

TEST(PcdReader, HeadersThatAreRefused)
{
    const std::string good =
        "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n";
    const auto with = [&](const std::string& line, const std::string& instead) {
        std::string text = good;
        return text.replace(text.find(line), line.size(), instead);
    };
    const struct {
        std::string bytes;
        ErrorCode code;
        const char* says;
    } cases[] = {
        {"1 2 3\n4 5 6\n", ErrorCode::bad_format, "line 1: found '1 2 3'"},
        {"VERSION .7\n", ErrorCode::bad_format, "DATA"},
        {with("FIELDS x y z\n", ""), ErrorCode::bad_format, "FIELDS"},
        {with("FIELDS x y z\n", "FIELDS x y w\n"), ErrorCode::bad_format, "'z'"},
        {with("FIELDS x y z\n", "FIELDS x y z X\nFIELDS x\n"), ErrorCode::bad_format, "line 2"},
        {with("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1", "FIELDS x y z Z"), ErrorCode::bad_format, "'z'"},
        {with("SIZE 4 4 4", "SIZE 4 4"), ErrorCode::bad_format, "SIZE"},
        {with("SIZE 4 4 4", "SIZE 4 4 3"), ErrorCode::bad_format, "SIZE 3"},
        {with("SIZE 4 4 4", "SIZE 4 4 -1"), ErrorCode::bad_format, "line 2"},
        {with("SIZE 4 4 4", "SIZE 4 4 0"), ErrorCode::bad_format, "SIZE 0"},
        {with("TYPE F F F", "TYPE F F G"), ErrorCode::bad_format, "'G'"},
        {with("TYPE F F F", "TYPE F F F F"), ErrorCode::bad_format, "TYPE"},
        {with("COUNT 1 1 1", "COUNT 1 1 0"), ErrorCode::bad_format, "COUNT 0"},
        {with("COUNT 1 1 1", "COUNT 1 2 1"), ErrorCode::bad_format, "COUNT 2"},
        {with("COUNT 1 1 1", "COUNT 1 1 18446744073709551615"), ErrorCode::unsupported, "16777216"},
        {with("POINTS 1", "POINTS 2"), ErrorCode::truncated, "2 points"},
        {with("POINTS 1", "POINTS 18446744073709551615"), ErrorCode::truncated, "18446744073709551615"},
        {with("POINTS 1", "POINTS 1 1"), ErrorCode::bad_format, "POINTS"},
        {with("WIDTH 1\nHEIGHT 1\nPOINTS 1\n", ""), ErrorCode::bad_format, "POINTS"},
        {with("WIDTH 1\nHEIGHT 1\nPOINTS 1\n", "WIDTH 18446744073709551615\nHEIGHT 2\n"), ErrorCode::bad_format,
         "WIDTH"},
        {with("DATA ascii", "DATA zip"), ErrorCode::unsupported, "'zip'"},
        {with("WIDTH 1", "width 1"), ErrorCode::bad_format, "'width 1'"},
    };
    TemporaryFolder folder;
    ASSERT_EQ(read_whole(write_file(folder / "a.pcd", good)).points.size, 1u);
    for (const auto& c : cases) {
        const auto path = write_file(folder / "a.pcd", c.bytes);
        const Error error = error_of([&] { open_reader(path); });
        EXPECT_EQ(error.code(), c.code) << c.bytes << error.what();
        EXPECT_TRUE(mentions(error.what(), c.says)) << c.bytes << error.what();
        EXPECT_TRUE(mentions(error.what(), path.string())) << error.what();
    }
    std::string endless = "# .PCD\n";
    while (endless.size() < 3000000) endless += "# nothing to see\n";
    EXPECT_EQ(error_of([&] { open_reader(write_file(folder / "a.pcd", endless)); }).code(), ErrorCode::bad_format);
    // Long, but real.
    const std::string large = endless.substr(0, endless.find('\n', 500000) + 1) + good;
    EXPECT_EQ(read_whole(write_file(folder / "a.pcd", large)).position(0), (Vec3d{1, 2, 3}));
}

TEST(PcdReader, LinesThatAreRefused)
{
    TemporaryFolder folder;
    const std::pair<const char*, const char*> cases[] = {
        {"1 2", "before the field 'z'"}, {"1 2 3 4", "'4'"}, {"1 2 three", "'three'"}, {"1 2 0x3", "'0x3'"}};
    for (const auto& [line, says] : cases) {
        const auto path = write_file(folder / "a.pcd", xyz_header(2, "ascii") + "1.25 2 3\n" + line + "\n");
        const Error error = error_of([&] { read_whole(*open_reader(path)); });
        EXPECT_EQ(error.code(), ErrorCode::bad_format);
        EXPECT_TRUE(mentions(error.what(), "line 13") && mentions(error.what(), says)) << error.what();
    }
    const auto path = write_file(folder / "a.pcd",
                                 pcd_header("x y z a", "4 4 4 1", "F F F U", "1 1 1 2", 1, "ascii") + "1 2 3 4 256\n");
    EXPECT_TRUE(mentions(error_of([&] { read_whole(*open_reader(path)); }).what(), "type u8"));
}

TEST(PcdReader, CompressedBlocksThatAreRefused)
{
    TemporaryFolder folder;
    const std::string header = xyz_header(2, "binary_compressed");
    const std::string packed = lzf_compress(std::string(24, 'a'));
    const auto block = [&](std::uint32_t compressed_size, std::uint32_t size, const std::string& bytes) {
        Bytes made;
        return header + made.put(compressed_size).put(size).raw(bytes).data;
    };
    const auto length = static_cast<std::uint32_t>(packed.size());
    ASSERT_EQ(read_whole(write_file(folder / "a.pcd", block(length, 24, packed))).points.size, 2u);
    const struct {
        std::string bytes;
        ErrorCode code;
        const char* says;
        bool at_open;
    } cases[] = {
        {header + "1234567", ErrorCode::truncated, "sizes", true},
        {block(length + 1, 24, packed), ErrorCode::truncated, "compressed block", true},
        {block(0xFFFFFFFF, 24, packed), ErrorCode::truncated, "4294967295", true},
        {block(length, 23, packed), ErrorCode::bad_format, "2 points of 12", true},
        {block(length, 36, packed), ErrorCode::bad_format, "36", true},
        {block(0, 24, ""), ErrorCode::corrupt, "cannot expand", true},
        {block(length - 1, 24, packed.substr(0, length - 1)), ErrorCode::corrupt, "end", false},
        {block(length + 2, 24, packed + std::string("\0a", 2)), ErrorCode::corrupt, "more than the stated number",
         false},
        {block(length, 24, lzf_compress(std::string(30, 'a'))), ErrorCode::corrupt, "more than the stated number",
         false},
    };
    for (const auto& c : cases) {
        const auto path = write_file(folder / "a.pcd", c.bytes);
        PointBatch batch;
        std::unique_ptr<PointReader> reader;
        const Error error = error_of([&] {
            reader = open_reader(path);
            reader->read(batch, 10);
        });
        EXPECT_EQ(error.code(), c.code) << error.what();
        EXPECT_EQ(reader == nullptr, c.at_open) << error.what();
        EXPECT_TRUE(mentions(error.what(), c.says) && mentions(error.what(), path.string())) << error.what();
    }
    // 4 GB stated for a few bytes: refused for the ratio, before memory is allocated.
    Bytes bomb;
    bomb.raw(xyz_header(357913941, "binary_compressed")).put(1000u).put(4294967292u).raw(std::string(1000, 'a'));
    EXPECT_EQ(error_of([&] { open_reader(write_file(folder / "a.pcd", bomb.data)); }).code(), ErrorCode::corrupt);
}

TEST(PcdReader, EveryTruncationIsNoticed)
{
    std::string columns;
    for (int i = 0; i < 48; ++i) columns += static_cast<char>(i * i / 3 % 7);
    const std::string files[] = {xyz_header(4, "ascii") + "1.25 2.25 3.25\n1.5 2.5 3.5\n-1 -2 -3\n10 20 305\n",
                                 xyz_header(4, "binary") + columns,
                                 xyz_header(4, "binary_compressed") + compressed(columns)};
    TemporaryFolder folder;
    for (const std::string& file : files) {
        for (std::size_t length = 0; length < file.size(); ++length) {
            const auto path = write_file(folder / "a.pcd", file.substr(0, length));
            if (&file == files && length > file.size() - 4) {  // text can be cut within its last number
                EXPECT_EQ(read_whole(path).points.size, 4u);
                continue;
            }
            const Error error = error_of([&] { read_whole(*open_reader(path)); });
            ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
            ASSERT_TRUE(error.code() == ErrorCode::bad_format || error.code() == ErrorCode::truncated ||
                        (length < 20 && error.code() == ErrorCode::unsupported) || mentions(error.what(), "encoding"))
                << length << error.what();
        }
        EXPECT_EQ(read_whole(write_file(folder / "a.pcd", file)).points.size, 4u);
    }
}

TEST(PcdReader, MoreAttributesThanASchemaHolds)
{
    std::string fields = "x y z", sizes = "4 4 4", kinds = "F F F", counts = "1 1 1", line = "0 0 0";
    const auto more = [&](int i) {
        fields += " a" + std::to_string(i), sizes += " 1", kinds += " U", counts += " 1", line += " 7";
    };
    for (int i = 0; i < 256; ++i) more(i);
    TemporaryFolder folder;
    const auto write = [&] {
        return write_file(folder / "a.pcd", pcd_header(fields, sizes, kinds, counts, 1, "ascii") + line + "\n");
    };
    EXPECT_EQ(read_whole(write()).value("a255", 0), 7);
    more(256);
    const Error error = error_of([&] { open_reader(write()); });
    EXPECT_EQ(error.code(), ErrorCode::unsupported);
    EXPECT_TRUE(mentions(error.what(), "a.pcd"));
}

TEST(PcdReader, CommentsThatAreNotTrue)
{
    const auto read = [](const std::string& comment) {
        TemporaryFolder folder;
        return read_whole(write_file(folder / "a.pcd",
                                     "# pcm attribute " + comment + "\n" +
                                         pcd_header("x y z a rgb", "4 4 4 1 4", "F F F U U", "1 1 1 2 1", 1, "ascii") +
                                         "1 2 3 4 5 6\n"));
    };
    EXPECT_EQ(read("a u8 2 0.5 1 pair -").value("pair", 0, 1), 5);
    EXPECT_EQ(read("rgb u8 3 0.5 1 rgb -").info.schema[1].scale, 0.5);
    for (const char* line : {"a u8 3 1 0 pair -", "a i8 2 1 0 pair -", "b u8 2 1 0 pair -", "x f32 1 1 0 pair -",
                             "a u8 2 1 0 rgb -", "rgb u32 1 1 0 pair -"}) {
        const Whole whole = read(line);
        EXPECT_EQ(whole.info.notes.size(), 1u) << line;
        EXPECT_EQ(whole.value("a", 0, 0), 4) << line;
        EXPECT_EQ(whole.value("rgb", 0, 2), 6) << line;
    }
    // A name that another field has: both are kept.
    const Whole swapped = read("rgb u8 3 1 0 a -");
    EXPECT_EQ(swapped.value("a", 0, 2), 6);
    EXPECT_EQ(swapped.value("a_2", 0, 1), 5);
}

}  // namespace
}  // namespace pcm::test
