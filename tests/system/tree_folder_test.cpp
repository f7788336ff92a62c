#include "pcm/system/tree_folder.h"

#include "tests/support.h"

#include <sys/stat.h>

#include <fstream>

namespace {

using namespace pcm;
namespace fs = std::filesystem;

class TreeFolder : public testing::Test {
protected:
    void write(const fs::path& path, const std::string& text = "text") const
    {
        fs::create_directories(path.parent_path());
        std::ofstream(path) << text;
    }
    // The beginning of a tree: enough to be recognised.
    fs::path tree(const std::string& name) const
    {
        write(folder_ / name / index_file_name, "PCMTREE\nand more");
        write(folder_ / name / "chunks-000.bpc");
        return folder_ / name;
    }
    const test::TemporaryFolder folder_;
};

TEST_F(TreeFolder, IsRecognisedByWhatItHolds)
{
    EXPECT_TRUE(is_tree_folder(tree("a.pct")));
    EXPECT_TRUE(is_tree_folder(tree("of any name")));
    write(folder_ / "lost index" / about_file_name, "PCMABOUT");
    EXPECT_TRUE(is_tree_folder(folder_ / "lost index"));
    write(folder_ / "damaged" / index_file_name, "");
    EXPECT_FALSE(is_tree_folder(folder_ / "damaged"));
    write(folder_ / "damaged" / "chunks-000.bpc");
    EXPECT_TRUE(is_tree_folder(folder_ / "damaged"));
}

TEST_F(TreeFolder, OtherFoldersAreNone)
{
    // Pictures have the extension too, and a tree may be called index.pct.
    write(folder_ / "pictures" / index_file_name, "a Macintosh picture");
    EXPECT_FALSE(is_tree_folder(folder_ / "pictures"));
    tree("project/index.pct");
    EXPECT_FALSE(is_tree_folder(folder_ / "project"));
    EXPECT_EQ(tree_folder_of(folder_ / "project/index.pct"), folder_ / "project/index.pct");
    write(folder_ / "loose" / "chunks-000.bpc");
    EXPECT_FALSE(is_tree_folder(folder_ / "loose"));
    EXPECT_FALSE(is_file_of_tree(folder_ / "loose/chunks-000.bpc"));
    EXPECT_FALSE(is_tree_folder(folder_ / "nothing"));
}

TEST_F(TreeFolder, AFifoIsNotWaitedFor)
{
    fs::create_directory(folder_ / "f");
    ASSERT_EQ(mkfifo((folder_ / "f" / index_file_name).c_str(), 0666), 0);
    EXPECT_FALSE(is_tree_folder(folder_ / "f"));
}

TEST_F(TreeFolder, StandsForTheFilesInIt)
{
    const fs::path made = tree("a.pct");
    write(made / "notes.txt");
    for (const char* name :
         {"index.pct", "about.pct", "chunks-000.bpc", "chunks-1234.bpc", "lock", "index.pct.damaged"})
        EXPECT_EQ(tree_folder_of(made / name), made) << name;
    for (const char* name : {"notes.txt", "chunks-0.bpc", "chunks-000.bpc.las", "x.bpc"})
        EXPECT_EQ(tree_folder_of(made / name), made / name) << name;
    EXPECT_EQ(tree_folder_of(made), made);
    EXPECT_EQ(tree_folder_of("index.pct"), ".");
    EXPECT_TRUE(is_file_of_tree(made / "chunks-000.bpc"));
    EXPECT_FALSE(is_file_of_tree(made));
    EXPECT_FALSE(is_file_of_tree(folder_ / "none" / "index.pct"));
}

TEST_F(TreeFolder, IsFoundThroughLinks)
{
    const fs::path made = tree("a.pct");
    fs::create_symlink("a.pct/chunks-000.bpc", folder_ / "short.bpc");
    EXPECT_EQ(tree_folder_of(folder_ / "short.bpc"), fs::canonical(made));
    // A data file may lie elsewhere: the tree is the folder with the link.
    write(folder_ / "disk/chunks-001.bpc");
    fs::create_symlink("../disk/chunks-001.bpc", made / "chunks-001.bpc");
    EXPECT_EQ(tree_folder_of(made / "chunks-001.bpc"), made);
    EXPECT_FALSE(is_file_of_tree(folder_ / "disk/chunks-001.bpc"));
}

TEST_F(TreeFolder, IsFoundAroundAPath)
{
    const fs::path made = tree("a.pct"), real = fs::canonical(made);
    fs::create_directory_symlink("a.pct", folder_ / "link");
    for (const fs::path& path : {made / "x.las", made / "no/such/folder/x.las", folder_ / "link" / "x.las",
                                 folder_ / "nowhere/../a.pct/x.las", made / "index.pct"})
        EXPECT_EQ(tree_folder_around(path), real) << path;
    for (const fs::path& path :
         {made, folder_ / "x.las", folder_ / "a.pct/../x.las", fs::path("/x.las"), fs::path("x")})
        EXPECT_FALSE(tree_folder_around(path)) << path;
    write(folder_ / "b.pct.part" / build_marker_name);
    EXPECT_EQ(tree_folder_around(folder_ / "b.pct.part/x.las"), fs::canonical(folder_ / "b.pct.part"));
}

}  // namespace
