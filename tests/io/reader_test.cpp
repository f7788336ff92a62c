#include "pcm/io/reader.h"

#include "pcm/tree/tree.h"
#include "tests/io/las_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

namespace pcm::test {
namespace {

const std::string small_ply =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
    "3\n";

std::string small_las()
{
    std::mt19937_64 random(1);
    return random_las(random, 2, 0, 1).bytes();
}

TEST(OpenReader, ContentCountsMoreThanTheExtension)
{
    TemporaryFolder folder;
    EXPECT_EQ(open_reader(write_file(folder / "cloud.las", small_ply))->info().format, "PLY ascii");
    EXPECT_EQ(open_reader(write_file(folder / "cloud.ply", small_las()))->info().format, "LAS 1.2, point format 0");
    EXPECT_EQ(open_reader(write_file(folder / "cloud", small_las()))->info().format, "LAS 1.2, point format 0");
    EXPECT_EQ(open_reader(write_file(folder / "cloud.XYZ", small_ply))->info().format, "PLY ascii");
}

TEST(OpenReader, SaysWhatItFound)
{
    struct {
        const char* name;
        std::string bytes;
        ErrorCode code;
        const char* says;
    } const cases[] = {
        {"a.las", "PLY!", ErrorCode::bad_format, "LASF"},
        {"a.ply", "plymouth", ErrorCode::bad_format, "line 1"},
        {"a.dat", std::string("\x01\x02zz", 4), ErrorCode::bad_format, "\\x01\\x02zz"},
        {"a.e57", "ASTM-E57....", ErrorCode::truncated, "1024 bytes"},
        {"a.las", "%PDF-1.7", ErrorCode::unsupported, "PDF"},
        {"a.xyz", "x marks the spot\n", ErrorCode::bad_format, "x marks the spot"},
        {"a.dat", "x marks the spot\n", ErrorCode::bad_format, "x marks the"},
        {"a.laz", "nonsense", ErrorCode::bad_format, "LASF"},
        {"a.las", "", ErrorCode::bad_format, "empty"},
    };
    TemporaryFolder folder;
    for (const auto& c : cases) {
        const auto path = write_file(folder / c.name, c.bytes);
        const Error error = error_of([&] { open_reader(path); });
        EXPECT_EQ(error.code(), c.code) << error.what();
        EXPECT_TRUE(mentions(error.what(), c.says)) << error.what();
        EXPECT_TRUE(mentions(error.what(), path.string())) << error.what();
    }
}

TEST(OpenReader, OnlyRegularFiles)
{
    TemporaryFolder folder;
    EXPECT_EQ(error_of([&] { open_reader(folder / "missing.las"); }).code(), ErrorCode::not_found);
    EXPECT_EQ(error_of([&] { open_reader(folder.path()); }).code(), ErrorCode::unsupported);
    ASSERT_EQ(mkfifo((folder / "pipe.las").c_str(), 0600), 0);
    EXPECT_EQ(error_of([&] { open_reader(folder / "pipe.las"); }).code(), ErrorCode::unsupported);
}

TEST(OpenReader, SeekOfFormatsWithoutIt)
{
    TemporaryFolder folder;
    const auto reader = open_reader(write_file(folder / "a.ply", small_ply));
    EXPECT_FALSE(reader->seekable());
    EXPECT_EQ(error_of([&] { reader->seek(0); }).code(), ErrorCode::unsupported);
}

TEST(ReadableExtensions, AreThoseOfTheFormats)
{
    std::vector<std::string> known = readable_extensions();
    for (const char* expected : {"bpc", "las", "laz", "ply", "xyz", "txt", "asc", "csv", "pwn", "pts", "ptx"})
        EXPECT_EQ(std::count(known.begin(), known.end(), expected), 1) << expected;
}

TEST(ExpandInputs, FoldersStandForTheirFilesAndThoseOfTheirSubFolders)
{
    namespace fs = std::filesystem;
    TemporaryFolder folder;
    const fs::path tiles = folder / "tiles";
    for (const char* name : {"deeper.las/deepest", "a", ".git", "site.pct", "other.pct.part", "tree", "empty"})
        fs::create_directories(tiles / name);
    for (const char* name :
         {"b.LAS", "a.ply", "z.las", "._a.las", ".hidden.xyz", ".DS_Store", "readme.txt", "a.prj", "deeper.las/c.las",
          "deeper.las/deepest/d.las", "a/e.las", "a/._e.las", ".git/f.las", "site.pct/chunks-000.bpc",
          "other.pct.part/chunks-000.bpc", "tree/index.pct", "tree/g.las"})
        write_file(tiles / name, "x");
    write_file(folder / "one.xyz", "x");
    write_file(folder / ".named.xyz", "x");
    fs::create_directory_symlink("..", tiles / "a" / "loop");
    fs::create_symlink("b.LAS", tiles / "linked.las");
    fs::create_symlink("nowhere.las", tiles / "lost.las");
    std::vector<std::string> notes;
    EXPECT_EQ(expand_inputs({folder / "one.xyz", tiles, folder / ".named.xyz"}, &notes),
              (std::vector<fs::path>{folder / "one.xyz", tiles / "a.ply", tiles / "b.LAS", tiles / "linked.las",
                                     tiles / "z.las", tiles / "a" / "e.las", tiles / "deeper.las" / "c.las",
                                     tiles / "deeper.las" / "deepest" / "d.las", folder / ".named.xyz"}));
    ASSERT_EQ(notes.size(), 1u);
    for (const char* part :
         {"tiles: left out of the folder", "5 hidden files and folders (", "2 files of other formats (",
          "1 text file that is not a list of points (readme.txt)", "3 point cloud trees, to be named themselves (",
          "1 link to a folder (a/loop)", "site.pct", "other.pct.part"})
        EXPECT_TRUE(mentions(notes[0], part)) << part << " in " << notes[0];
    EXPECT_TRUE(expand_inputs({}).empty());
    // What is left out is in the message when nothing else is there.
    const Error error = error_of([&] { expand_inputs({tiles / "empty"}); });
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    write_file(tiles / "empty" / ".a.las", "x");
    EXPECT_TRUE(
        mentions(error_of([&] { expand_inputs({tiles / "empty"}); }).what(), "1 hidden file or folder (.a.las)"));
    for (const char* tree : {"site.pct", "site.pct/", "tree"})
        EXPECT_EQ(error_of([&] { expand_inputs({tiles / tree}); }).code(), ErrorCode::unsupported) << tree;
}

TEST(ExpandInputs, TreesAreKnownByTheirNames)
{
    // The folder names are written down in two rooms, of which one may not see the other.
    TemporaryFolder folder;
    std::filesystem::create_directories(folder / "a" / "inner");
    write_file(folder / "a" / "b.las", "x");
    write_file(folder / "a" / "inner" / "c.las", "x");
    write_file(folder / "a" / "inner" / index_file_name, "x");
    std::filesystem::create_directories(folder / "a" / (std::string("d.") + tree_extension));
    write_file(folder / "a" / (std::string("d.") + tree_extension) / "c.las", "x");
    EXPECT_EQ(expand_inputs({folder / "a"}), (std::vector<std::filesystem::path>{folder / "a" / "b.las"}));
}

TEST(ExpandInputs, FoldersThatCannotBeListed)
{
    if (geteuid() == 0) GTEST_SKIP() << "root lists every folder";
    TemporaryFolder folder;
    std::filesystem::create_directories(folder / "a" / "closed");
    write_file(folder / "a" / "b.las", "x");
    std::filesystem::permissions(folder / "a" / "closed", std::filesystem::perms::none);
    EXPECT_EQ(error_of([&] { expand_inputs({folder / "a"}); }).code(), ErrorCode::permission);
    std::vector<std::string> notes;
    EXPECT_EQ(expand_inputs({folder / "a"}, &notes, true).size(), 1u);
    EXPECT_TRUE(mentions(notes.at(0), "1 folder that cannot be read (closed)")) << notes[0];
    std::filesystem::permissions(folder / "a" / "closed", std::filesystem::perms::owner_all);
}

TEST(ExpandInputs, RefusesWhatIsNotThere)
{
    TemporaryFolder folder;
    EXPECT_EQ(error_of([&] { expand_inputs({folder / "missing"}); }).code(), ErrorCode::not_found);
    const Error error = error_of([&] { expand_inputs({folder.path()}); });
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    EXPECT_TRUE(mentions(error.what(), ".las")) << error.what();
}

}  // namespace
}  // namespace pcm::test
