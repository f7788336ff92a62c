// Real files, compared with the results of other readers.
#include "tests/io/bytes.h"

#include <cmath>
#include <map>
#include <sstream>

namespace pcm::test {
namespace {

// Fields of one line of a CSV file with quotes; no field of the manifest has a line end.
std::vector<std::string> csv_fields(const std::string& line)
{
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            fields.emplace_back();
        else if (c != '\r')
            fields.back() += c;
    }
    return fields;
}

std::map<std::string, std::vector<std::string>> manifest()
{
    std::ifstream file(sample("MANIFEST.csv"));
    std::map<std::string, std::vector<std::string>> lines;
    for (std::string line; std::getline(file, line);) {
        const auto fields = csv_fields(line);
        lines[fields[0]] = fields;
    }
    return lines;
}

// Half a unit of the last printed digit, plus the error of single precision.
double tolerance_of(const std::string& printed, double value)
{
    const std::size_t point = printed.find('.');
    const std::size_t decimals = point == std::string::npos ? 0 : printed.size() - point - 1;
    return 0.501 * std::pow(10.0, -static_cast<double>(decimals)) + std::abs(value) * 1e-15;
}

void expect_as_in_manifest(const std::string& folder, const std::string& extension, std::size_t at_least)
{
    std::size_t files = 0;
    for (const auto& [name, fields] : manifest()) {
        if (name.compare(0, folder.size(), folder) != 0 || std::filesystem::path(name).extension() != extension)
            continue;
        SCOPED_TRACE(name);
        ++files;
        const Whole whole = read_whole(sample(name));
        // For E57 the manifest has the number of valid positions.
        const bool some = fields[4].compare(0, 5, "read ") == 0;
        EXPECT_EQ(std::to_string(whole.points.size),
                  some ? fields[4].substr(5, fields[4].find(' ', 5) - 5) : fields[2]);
        std::istringstream printed(fields[3]);
        Box3d box;
        for (std::size_t i = 0; i < whole.points.size; ++i) box.extend(whole.position(i));
        for (const Vec3d& corner : {box.min, box.max})
            for (std::size_t a = 0; a < 3; ++a) {
                std::string text;
                if (!(printed >> text)) continue;
                EXPECT_NEAR(corner[a], std::stod(text), tolerance_of(text, corner[a]));
            }
    }
    EXPECT_GE(files, at_least);
}

TEST(SampleClouds, Las)
{
    PCM_REQUIRE_SAMPLE("MANIFEST.csv");
    expect_as_in_manifest("las/", ".las", 20);
    expect_as_in_manifest("crossformat/", ".las", 1);
}

TEST(SampleClouds, Ply)
{
    PCM_REQUIRE_SAMPLE("MANIFEST.csv");
    expect_as_in_manifest("ply/", ".ply", 14);
    expect_as_in_manifest("primitives/", ".ply", 4);
    expect_as_in_manifest("crossformat/", ".ply", 2);
}

TEST(SampleClouds, E57)
{
    PCM_REQUIRE_SAMPLE("MANIFEST.csv");
    try {
        open_reader(sample("e57/A_B.e57"));
    } catch (const Error& error) {
        if (error.code() == ErrorCode::unsupported) GTEST_SKIP() << "this build does not support E57";
        throw;
    }
    expect_as_in_manifest("e57/", ".e57", 11);
}

TEST(SampleClouds, Pcd)
{
    PCM_REQUIRE_SAMPLE("MANIFEST.csv");
    expect_as_in_manifest("pcd/", ".pcd", 14);
    expect_as_in_manifest("primitives/", ".pcd", 5);
    // Points without a measurement are present, with NaN positions.
    std::size_t organised = 0;
    for (const auto& [name, fields] : manifest()) {
        const std::size_t at = fields[4].find("; ");
        if (at == std::string::npos || std::filesystem::path(name).extension() != ".pcd") continue;
        ++organised;
        const Whole whole = read_whole(sample(name));
        std::size_t missing = 0;
        for (std::size_t i = 0; i < whole.points.size; ++i) missing += std::isnan(whole.position(i)[0]);
        EXPECT_EQ(missing, std::stoul(fields[4].substr(at + 2))) << name;
    }
    EXPECT_GE(organised, 4u);
}

TEST(SampleClouds, TheSameCloudInThreeFormats)
{
    PCM_REQUIRE_SAMPLE("crossformat");
    const Whole las = read_whole(sample("crossformat/ripple.las"));
    const Whole ascii = read_whole(sample("crossformat/ripple_ascii.ply"));
    const Whole binary = read_whole(sample("crossformat/ripple_bin.ply"));
    ASSERT_EQ(las.points.size, ascii.points.size);
    ASSERT_EQ(las.points.size, binary.points.size);
    EXPECT_EQ(ascii.info.schema, binary.info.schema);
    for (std::size_t i = 0; i < las.points.size; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            // Text of six decimals; the grid of the LAS file.
            ASSERT_NEAR(ascii.position(i)[a], binary.position(i)[a], 1e-6);
            ASSERT_NEAR(las.position(i)[a], binary.position(i)[a], 1e-6);
            ASSERT_EQ(ascii.value("rgb", i, static_cast<std::uint32_t>(a)),
                      binary.value("rgb", i, static_cast<std::uint32_t>(a)));
        }
}

TEST(SampleClouds, Text)
{
    PCM_REQUIRE_SAMPLE("MANIFEST.csv");
    expect_as_in_manifest("xyz/", ".xyz", 5);
    expect_as_in_manifest("xyz/", ".txt", 7);
    expect_as_in_manifest("pts/", ".pts", 4);
    expect_as_in_manifest("ptx/", ".ptx", 2);
    expect_as_in_manifest("derived/", ".ptx", 1);
    expect_as_in_manifest("primitives/", ".xyz", 1);
    expect_as_in_manifest("primitives/", ".pwn", 1);
    expect_as_in_manifest("crossformat/", ".txt", 1);
    expect_as_in_manifest("crossformat/", ".pts", 1);
}

TEST(SampleClouds, BadFilesAreRefusedByName)
{
    PCM_REQUIRE_SAMPLE("bad");
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(sample("bad"))) {
        const auto extension = entry.path().extension();
        if (extension != ".las" && extension != ".laz" && extension != ".pcd" && extension != ".ply") continue;
        ++files;
        const Error error = error_of([&] { read_whole(*open_reader(entry.path())); });
        EXPECT_TRUE(mentions(error.what(), entry.path().string())) << error.what();
        EXPECT_NE(error.code(), ErrorCode::io) << error.what();
    }
    EXPECT_GE(files, 6u);
}

TEST(SampleClouds, EdgeCases)
{
    PCM_REQUIRE_SAMPLE("edge");
    const std::map<std::string, std::size_t> readable = {
        {"bad_vlr_count.las", 10}, {"malformed_extrabytes.las", 10}, {"cube_binary_header_with_RN_newline.ply", 8},
        {"empty_ok_ascii.ply", 0}, {"simple_text.ply", 3},           {"utm17_comma.pcd", 10},
        {"utm17_tab.pcd", 10}};
    for (const auto& entry : std::filesystem::directory_iterator(sample("edge"))) {
        const auto extension = entry.path().extension();
        if (extension != ".las" && extension != ".pcd" && extension != ".ply") continue;
        SCOPED_TRACE(entry.path().filename());
        const auto known = readable.find(entry.path().filename().string());
        if (known != readable.end()) {
            EXPECT_EQ(read_whole(entry.path()).points.size, known->second);
        } else {
            const Error error = error_of([&] { read_whole(*open_reader(entry.path())); });
            EXPECT_EQ(error.code(), ErrorCode::bad_format) << error.what();
        }
    }
    EXPECT_TRUE(any_mentions(open_reader(sample("edge/bad_vlr_count.las"))->info().notes, "VLR 3 of 3"));
    EXPECT_TRUE(any_mentions(open_reader(sample("edge/malformed_extrabytes.las"))->info().notes, "Extra Bytes"));
    const Whole cube = read_whole(sample("edge/cube_binary_header_with_RN_newline.ply"));
    for (std::size_t i = 0; i < 8; ++i)
        for (const double c : cube.position(i)) EXPECT_TRUE(c == 0 || c == 1);
}

}  // namespace
}  // namespace pcm::test
