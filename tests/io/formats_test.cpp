// The table of formats: every row can be found by its extensions and its magic, and says nothing that contradicts
// others.
#include "pcm/io/formats.h"

#include "pcm/io/writer.h"
#include "pcm/system/output_path.h"
#include "tests/io/bytes.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pcm::test {
namespace {

TEST(Formats, EveryRowIsFoundByItsExtensionsAndItsMagic)
{
    std::set<std::string_view> seen;
    for (const Format& format : formats()) {
        ASSERT_FALSE(format.extensions[0].empty());
        EXPECT_FALSE(format.label.empty()) << format.extensions[0];
        EXPECT_NE(format.open, nullptr) << format.extensions[0];
        for (const std::string_view extension : format.extensions) {
            if (!extension.empty()) EXPECT_TRUE(is_point_file_name("a." + std::string(extension))) << extension;
            if (extension.empty()) continue;
            EXPECT_TRUE(seen.insert(extension).second) << extension << " is in two rows";
            EXPECT_EQ(format_of_extension(extension), &format) << extension;
        }
        for (const std::string_view magic : format.magic) {
            if (magic.empty()) continue;
            const Format* const found = format_of_magic(std::string(magic) + "...");
            ASSERT_NE(found, nullptr) << magic;
            EXPECT_EQ(found->open, format.open) << magic;  // LAS and LAZ share their magic and their reader
            EXPECT_EQ(foreign_format_of_magic(magic), nullptr) << magic;
        }
    }
    EXPECT_EQ(format_of_extension(""), nullptr);
    EXPECT_EQ(format_of_extension("LAS"), nullptr);
    EXPECT_EQ(format_of_magic(""), nullptr);
    EXPECT_EQ(format_of_magic("LAS"), nullptr);
    EXPECT_EQ(format_of_magic("plymouth"), nullptr);
}

TEST(Formats, OtherProgramsFilesAreNamed)
{
    const std::pair<const char*, const char*> files[] = {{"[Expe/PointSet v1", "an Expe point set"},
                                                         {"PK\x03\x04 and more", "a ZIP archive"},
                                                         {"\x1f\x8b\x08", "gzip data"},
                                                         {"%PDF-1.4", "a PDF file"},
                                                         {"\x89PNG\r\n", "a PNG picture"},
                                                         {"POTREE2", "Potree data"}};
    for (const auto& [bytes, name] : files) {
        const ForeignFormat* const format = foreign_format_of_magic(bytes);
        ASSERT_NE(format, nullptr) << name;
        EXPECT_EQ(format->name, name);
    }
    ASSERT_NE(foreign_format_of_extension("stl"), nullptr);
    EXPECT_EQ(foreign_format_of_extension("pts"), nullptr);  // ours as well
}

TEST(Formats, AFileOfNoMoreThanAMagicIsRecognised)
{
    TemporaryFolder folder;
    for (const Format& format : formats())
        for (const std::string_view magic : format.magic)
            if (!magic.empty())
                EXPECT_TRUE(format.begins(first_bytes_of(write_file(folder / "a", std::string(magic))))) << magic;
}

TEST(Formats, TraitsOfWritingBelongToFormatsThatAreWritten)
{
    for (const Format& format : formats())
        if (format.has(needs_grid) || format.has(takes_decimals) || format.has(takes_ascii) ||
            format.has(takes_las_version) || format.has(takes_colour_bits) || format.has(takes_float_positions) ||
            format.questions)
            EXPECT_NE(format.create, nullptr) << format.extensions[0];
    EXPECT_EQ(extensions_with(takes_las_version), ".las and .laz");
    EXPECT_EQ(extensions_with(takes_colour_bits), ".pcd and .ply");
    EXPECT_EQ(extensions_with(takes_float_positions), ".pcd");
    EXPECT_EQ(extensions_with(needs_grid), ".las and .laz");
    EXPECT_EQ(extensions_with(takes_decimals), ".xyz, .txt, .asc, .csv and .pts");
    EXPECT_EQ(extensions_with(takes_ascii), ".pcd and .ply");
    EXPECT_EQ(extensions_with(asks_layout), ".xyz, .txt, .asc and .csv");
    EXPECT_EQ(extensions_with(common_extension), ".txt, .asc and .csv");
    EXPECT_EQ(extensions_with(unique_structure), ".ptx");
}

TEST(Formats, WritableExtensionsAreThoseOfWriters)
{
    const std::vector<std::string> extensions = writable_extensions();
    EXPECT_EQ(std::set<std::string>(extensions.begin(), extensions.end()).size(), extensions.size());
    for (const char* const wanted : {"las", "laz", "ply", "pcd", "pts", "xyz", "csv", "bpc"})
        EXPECT_EQ(std::count(extensions.begin(), extensions.end(), wanted), 1) << wanted;
    for (const char* const read : {"e57", "ptx", "pwn"})
        EXPECT_EQ(std::count(extensions.begin(), extensions.end(), read), 0) << read;
    for (const std::string& extension : extensions)
        EXPECT_TRUE(std::any_of(formats().begin(), formats().end(), [&](const Format& format) {
            return format.create && !extension.empty() &&
                   std::count(format.extensions.begin(), format.extensions.end(), extension) == 1;
        })) << extension;
}

TEST(Formats, MeshesAndForeignFilesOfTheSameExtensionAreNotPointClouds)
{
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face ";
    const std::string list = "\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n";
    const std::string expe = "[Expe/PointSet\n1 2 3\n";
    TemporaryFolder folder;
    EXPECT_FALSE(is_point_cloud(write_file(folder / "mesh.PLY", ply + "1" + list + "3 0 0 0\n")));
    EXPECT_TRUE(is_point_cloud(write_file(folder / "cloud.ply", ply + "0" + list)));
    EXPECT_FALSE(is_point_cloud(write_file(folder / "expe.pts", expe)));
    EXPECT_TRUE(is_point_cloud(write_file(folder / "leica.pts", "1\n1 2 3\n")));
    EXPECT_TRUE(is_point_cloud(write_file(folder / "archive.pts", "PK\x03\x04")));  // our reader refuses it by name
    EXPECT_TRUE(is_point_cloud(write_file(folder / "expe.xyz", expe)));
    EXPECT_TRUE(is_point_cloud(write_file(folder / "damaged.ply", "plymouth")));
    EXPECT_TRUE(is_point_cloud(folder / "missing.ply"));
    EXPECT_TRUE(is_point_cloud(folder / "missing.pts"));
}

}  // namespace
}  // namespace pcm::test
