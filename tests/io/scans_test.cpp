// Numbers of scans through several files, and where the scanner stood.
#include "pcm/io/scans.h"

#include "pcm/io/pipe/merged_reader.h"
#include "tests/io/text/read_text.h"

#include <gtest/gtest.h>

#include <cstring>

namespace pcm::test {
namespace {

Metadata block_of(const std::string& key, const std::string& text)
{
    Metadata block{key, std::vector<std::byte>(text.size())};
    std::memcpy(block.value.data(), text.data(), text.size());
    return block;
}

std::string scan_at(const std::string& place, const std::string& points, int count)
{
    return "1\n" + std::to_string(count) + "\n7 7 7\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n" + place +
           " 1\n" + points;
}

TEST(Scans, PositionsAreThoseOfTheTransforms)
{
    const auto positions = scan_positions(
        {block_of("ptx.scan/2", scan_at("500 -600.25 7", "", 0)), block_of("e57.scan/1/pose", "1.5 2 3 1 0 0 0"),
         block_of("e57.scan/4/name", "5 6 7"), block_of("e57.scan/5/pose", "1 nan 3 1 0 0 0"),
         block_of("ptx.scan/x", "1 2 3"), block_of("comment", "e57.scan/9/pose")});
    ASSERT_EQ(positions.size(), 2u);
    EXPECT_EQ(positions.at(2), (Vec3d{500, -600.25, 7}));
    EXPECT_EQ(positions.at(1), (Vec3d{1.5, 2, 3}));
}

TEST(Scans, KeysAreRenumbered)
{
    EXPECT_EQ(renumbered("ptx.scan/2", 7), "ptx.scan/9");
    EXPECT_EQ(renumbered("e57.scan/12/pose", 3), "e57.scan/15/pose");
    for (const char* key :
         {"e57.xml", "ptx.scan/", "ptx.scan/a", "las.scan/1", "", "ptx.scan/0", "ptx.scan/99999999999"})
        EXPECT_EQ(renumbered(key, 4), key);
}

TEST(Scans, BlocksThatAreNoPosesHaveNoPosition)
{
    const std::string good = scan_at("1 2 3", "", 0);
    const auto positions = scan_positions(
        {block_of("ptx.scan/1/more", good), block_of("e57.scan/2", "1 2 3"), block_of("e57.scan/3/poses", "1 2 3"),
         block_of("ptx.scan/4/pose", "7 8 9"), block_of("e57.scan/5/pose", "1 2"), block_of("e57.scan/6/pose", "1 2 x"),
         block_of("ptx.scan/7", good.substr(0, good.find("1 2 3"))), block_of("e57.scan/8/pose", "inf 2 3"),
         block_of("ptx.scan/0", good), block_of("e57.scan/4294967296/pose", "1 2 3"), block_of("e57.scan/9/pose", "")});
    ASSERT_EQ(positions.size(), 1u);
    EXPECT_EQ(positions.at(4), (Vec3d{7, 8, 9}));
}

TEST(Scans, FilesHaveAsManyScansAsTheirMetadataNumber)
{
    Schema plain, numbered;
    plain.add({"intensity", ScalarType::u32, 1, 1, 0, ""});
    numbered.add({scan_attribute, ScalarType::u32, 1, 1, 0, ""});
    EXPECT_EQ(scans_of({}, plain), 0u);
    EXPECT_EQ(scans_of({}, numbered), 0u);
    EXPECT_EQ(scans_of({block_of("ptx.scan/1", "")}, plain), 1u);
    // The others are not known before the file has been read.
    EXPECT_EQ(scans_of({block_of("ptx.scan/1", "")}, numbered), 10000u);
    for (const Schema& schema : {plain, numbered})
        EXPECT_EQ(
            scans_of({block_of("e57.scan/3/pose", ""), block_of("ptx.scan/12", ""), block_of("other/20", "")}, schema),
            12u);
}

TEST(Scans, NumbersHaveAPlaceOfTheirOwnKind)
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    EXPECT_EQ(place_for_scan_numbers(schema), std::optional<std::size_t>(1));
    ASSERT_EQ(schema.size(), 2u);
    EXPECT_EQ(schema[1].name, scan_attribute);
    EXPECT_EQ(schema[1].type, ScalarType::u32);
    EXPECT_EQ(schema[1].scale, 1);
    EXPECT_EQ(schema[1].offset, 0);
    EXPECT_EQ(place_for_scan_numbers(schema), std::optional<std::size_t>(1)) << "it is there";
    EXPECT_EQ(schema.size(), 2u);
    const Attribute others[] = {{scan_attribute, ScalarType::u16, 1, 1, 0, ""},
                                {scan_attribute, ScalarType::u32, 2, 1, 0, ""},
                                {scan_attribute, ScalarType::u32, 1, 2, 0, ""},
                                {scan_attribute, ScalarType::u32, 1, 1, 3, ""}};
    for (const Attribute& other : others) {
        Schema taken;
        taken.add(other);
        EXPECT_FALSE(place_for_scan_numbers(taken));
        EXPECT_EQ(taken.size(), 1u);
    }
}

TEST(Scans, NumbersFollowThoseOfTheFilesBefore)
{
    for (const bool numbered : {true, false}) {
        Column column(ScalarType::u32, 1);
        column.resize(4);
        for (std::uint32_t i = 0; i < 4; ++i) column.as<std::uint32_t>()[i] = i % 3 + 1;
        number_scans(column, 3, 10, numbered);
        const std::uint32_t expected[] = {11, numbered ? 12u : 11u, numbered ? 13u : 11u, 1};
        for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(column.as<std::uint32_t>()[i], expected[i]) << numbered << i;
    }
}

// Files of one scan each, of two, and one of another format.
TEST(Scans, ScansOfSeveralFilesAreNumberedThrough)
{
    const TemporaryFolder folder;
    write_file(folder / "a.ptx", scan_at("100 0 0", "1 0 0 0.5\n2 0 0 0.5\n", 2));
    write_file(folder / "b.ptx", scan_at("200 0 0", "1 0 0 0.5\n", 1) + scan_at("300 0 0", "1 0 0 0.5\n", 1));
    write_file(folder / "c.ptx", scan_at("400 0 0", "1 0 0 0.5\n", 1));
    write_file(folder / "d.xyz", "1 2 3\n4 5 6\n");
    MergedReader reader({folder / "a.ptx", folder / "b.ptx", folder / "c.ptx", folder / "d.xyz"}, {});
    const Whole whole = read_whole(reader, 2);
    ASSERT_EQ(whole.points.size, 7u);
    const double scans[] = {1, 1, 2, 3, 4, 0, 0};
    for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(whole.value("scan", i), scans[i]) << i;
    const auto positions = scan_positions(whole.info.metadata);
    ASSERT_EQ(positions.size(), 4u);
    for (std::uint32_t n = 1; n <= 4; ++n) EXPECT_EQ(positions.at(n)[0], 100.0 * n);
    std::string notes;
    for (const std::string& note : reader.info().notes) notes += note + "\n";
    EXPECT_NE(notes.find("'scan' is not in 1 of 4 files and zero there: d.xyz"), std::string::npos) << notes;
    // A file alone gets no attribute `scan`.
    MergedReader alone({folder / "a.ptx"}, {});
    EXPECT_FALSE(alone.info().schema.find("scan"));
    EXPECT_EQ(scans_of(alone.info().metadata, alone.info().schema), 1u);
}

}  // namespace
}  // namespace pcm::test
