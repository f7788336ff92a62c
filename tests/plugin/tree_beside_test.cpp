#include "plugin/scene/tree_beside.h"

#include "tests/plugin/scenes.h"

#include <chrono>
#include <fstream>

namespace pcm::host {
namespace {

TEST(TreeBeside, InAFolderNamesTellFilesOfOneNameApart)
{
    const fs::path one = tree_path("/a/scan.las", "/trees"), two = tree_path("/b/scan.las", "/trees");
    EXPECT_EQ(one.parent_path(), "/trees");
    EXPECT_EQ(one.extension(), ".pct");
    EXPECT_NE(one, two);
    EXPECT_EQ(one, tree_path("/a/../a/scan.las", "/trees"));
    EXPECT_NE(one, tree_path("/a/scan.laz", "/trees"));
}

TEST(TreeBeside, IsBuiltOnceAndAgainWhenTheFileChanges)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    const fs::path tree = folder / "a.pct";
    EXPECT_EQ(tree_path(las), tree);
    const auto ensure = [&] { return ensure_tree({las, tree_path(las), {}, false}, open_reader(las)->info(), {}); };
    EXPECT_EQ(ensure().at(0).rfind("Built", 0), 0u);
    EXPECT_NE(ensure().at(0).find("up to date"), std::string::npos);
    scene(folder, "a.las", 21000, far_away);
    EXPECT_FALSE(tree_is_current(tree, las, 21000));
    EXPECT_EQ(ensure().at(0).rfind("Built", 0), 0u);
    EXPECT_EQ(Tree::open(tree)->info().points, 21000u);
    // As many points, but newer than the tree.
    fs::last_write_time(las, fs::last_write_time(tree / index_file_name) + std::chrono::seconds(5));
    EXPECT_FALSE(tree_is_current(tree, las, 21000));
}

TEST(TreeBeside, NeverReplacesWhatIsNotItsOwn)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    const auto ensure = [&] { ensure_tree({las, tree_path(las), {}, false}, open_reader(las)->info(), {}); };

    const fs::path other = tree_of(scene(folder, "b.las", 20000, far_away));
    fs::rename(other, folder / "a.pct");
    EXPECT_THROW(ensure(), Error);
    EXPECT_EQ(Tree::open(folder / "a.pct")->info().sources.at(0), "b.las");
    fs::remove_all(folder / "a.pct");

    std::ofstream(folder / "a.pct") << "a letter";
    EXPECT_THROW(ensure(), Error);
    EXPECT_EQ(fs::file_size(folder / "a.pct"), 8u);
}

}  // namespace
}  // namespace pcm::host
