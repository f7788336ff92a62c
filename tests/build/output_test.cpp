// Where a build puts its tree: never into another tree, never over a user's folder or through a link in its own.

#include "pcm/build/builder.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/unfinished_build.h"
#include "pcm/tree/verify.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/support.h"

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class BuildOutput : public testing::Test {
protected:
    BuildOutput()
    {
        write_las(folder_ / "in.las", records(Shape::surface, 500, 1), {});
        write_las(folder_ / "other.las", records(Shape::surface, 300, 2), {});
        options_ = small_chunks();
        options_.overwrite = true;
        build("tree.pct");
    }
    void build(const fs::path& output, const char* input = "in.las")
    {
        build_tree({folder_ / input}, folder_ / output, options_);
    }
    // The code of the refusal, which must have this word.
    ErrorCode refusal_of(const fs::path& output, const std::string& word, const char* input = "in.las")
    {
        try {
            build(output, input);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
            return error.code();
        }
        ADD_FAILURE() << output << " was built";
        return ErrorCode::io;
    }
    const TemporaryFolder folder_;
    BuildOptions options_;
};

TEST_F(BuildOutput, TheIndexOfATreeIsNotReplaced)
{
    const Contents before = contents(folder_ / "tree.pct");
    for (const bool overwrite : {false, true}) {
        options_.overwrite = overwrite;
        EXPECT_EQ(refusal_of("tree.pct/index.pct", "did you mean the tree?"), ErrorCode::invalid_argument);
        EXPECT_EQ(refusal_of("tree.pct/chunks-000.bpc", "a file of the point cloud tree"), ErrorCode::invalid_argument);
        EXPECT_EQ(refusal_of("tree.pct/inner.pct", "inside the folder"), ErrorCode::invalid_argument);
    }
    EXPECT_EQ(contents(folder_ / "tree.pct"), before);
}

TEST_F(BuildOutput, AFolderWithUsersFilesIsNotReplaced)
{
    std::ofstream(folder_ / "tree.pct/notes.txt") << "years of work";
    EXPECT_EQ(refusal_of("tree.pct", "notes.txt"), ErrorCode::exists);
    // The name of the index proves nothing.
    fs::create_directory(folder_ / "pictures");
    std::ofstream(folder_ / "pictures/index.pct") << "a Macintosh picture";
    EXPECT_EQ(refusal_of("pictures", "not a point cloud tree"), ErrorCode::exists);
    std::ofstream(folder_ / "file.pct") << "years of work";
    EXPECT_EQ(refusal_of("file.pct", "this is a file"), ErrorCode::exists);
    EXPECT_EQ(names_in(folder_.path()),
              (std::vector<std::string>{"file.pct", "in.las", "other.las", "pictures", "tree.pct"}));
}

TEST_F(BuildOutput, ATreeBehindALinkIsReplacedWhereItIs)
{
    fs::create_directory(folder_ / "disk");
    fs::rename(folder_ / "tree.pct", folder_ / "disk/real.pct");
    fs::create_directory_symlink("disk/real.pct", folder_ / "tree.pct");
    build("tree.pct", "other.las");
    EXPECT_TRUE(fs::is_symlink(folder_ / "tree.pct"));
    EXPECT_EQ(Tree::open(folder_ / "disk/real.pct")->info().points, 300u);
    EXPECT_EQ(names_in(folder_ / "disk"), std::vector<std::string>{"real.pct"});
    fs::remove_all(folder_ / "disk/real.pct");
    EXPECT_EQ(refusal_of("tree.pct", "does not exist"), ErrorCode::not_found);
}

TEST_F(BuildOutput, AWorkFolderBehindALinkIsRefused)
{
    for (const bool marked : {false, true}) {
        fs::create_directory(folder_ / "mine");
        std::ofstream(folder_ / "mine/thesis.txt") << "years of work";
        if (marked) std::ofstream(folder_ / "mine" / build_marker_name);
        fs::create_directory_symlink("mine", folder_ / "tree.pct.part");
        EXPECT_EQ(refusal_of("tree.pct", "in the way"), ErrorCode::exists);
        EXPECT_TRUE(fs::exists(folder_ / "mine/thesis.txt"));
        fs::remove(folder_ / "tree.pct.part");
        fs::remove_all(folder_ / "mine");
    }
}

TEST_F(BuildOutput, TheMarkOfABuildIsNotMadeThroughALink)
{
    std::ofstream(folder_ / "mine") << "years of work";
    for (const char* target : {"../mine", "../made"}) {
        fs::create_directory(folder_ / "tree.pct.part");
        fs::create_symlink(target, folder_ / "tree.pct.part/building");
        EXPECT_EQ(refusal_of("tree.pct", "symbolic link"), ErrorCode::unsupported);
        EXPECT_EQ(fs::file_size(folder_ / "mine"), 13u);
        EXPECT_FALSE(fs::exists(folder_ / "made"));
        fs::remove_all(folder_ / "tree.pct.part");
    }
    EXPECT_EQ(Tree::open(folder_ / "tree.pct")->info().points, 500u);
}

TEST_F(BuildOutput, LinksAmongTheRemainsOfABuildAreRemovedNotFollowed)
{
    fs::create_directory(folder_ / "mine");
    std::ofstream(folder_ / "mine/thesis.txt") << "years of work";
    for (const char* name : {"tree", "old", "points.tmp", "journal", "publishing"}) {
        fs::create_directory(folder_ / "tree.pct.part");
        std::ofstream(folder_ / "tree.pct.part/building");
        const bool is_folder = name == std::string("tree") || name == std::string("old");
        fs::create_symlink(is_folder ? "../mine" : "../mine/thesis.txt", folder_ / "tree.pct.part" / name);
        build("tree.pct", "other.las");
        EXPECT_EQ(fs::file_size(folder_ / "mine/thesis.txt"), 13u) << name;
        EXPECT_EQ(names_in(folder_ / "mine").size(), 1u) << name;
        EXPECT_EQ(Tree::open(folder_ / "tree.pct")->info().points, 300u);
        EXPECT_FALSE(fs::exists(folder_ / "tree.pct.part"));
    }
    // A link is not a tree that an interrupted build has put aside.
    fs::create_directory(folder_ / "gone.pct.part");
    fs::create_directory_symlink("../mine", folder_ / "gone.pct.part/old");
    EXPECT_FALSE(was_being_replaced(folder_ / "gone.pct"));
}

TEST_F(BuildOutput, TreesAndTheirFilesAreNoInputFiles)
{
    for (const char* input : {"tree.pct", "tree.pct/chunks-000.bpc", "tree.pct/index.pct"}) {
        EXPECT_EQ(refusal_of("new.pct", "point cloud tree", input), ErrorCode::unsupported);
        EXPECT_FALSE(fs::exists(folder_ / "new.pct"));
    }
    // Without its index it is a damaged tree, whose data files have points that were deleted.
    fs::remove(folder_ / "tree.pct/index.pct");
    EXPECT_EQ(refusal_of("new.pct", "point cloud tree", "tree.pct"), ErrorCode::unsupported);
}

}  // namespace
