// Trees whose index has no pages, as programs wrote it before: every update makes the same tree of them as of others,
// with an index of today.
#include "pcm/tree/verify.h"
#include "pcm/update/append.h"
#include "pcm/update/clone.h"
#include "pcm/update/compact.h"
#include "pcm/update/erase.h"
#include "pcm/update/repair.h"
#include "tests/tree/index_of_version_3.h"
#include "tests/tree/small_tree.h"
#include "tests/update/model.h"

#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class Version3 : public testing::Test {
protected:
    static std::vector<std::byte> index(const fs::path& tree) { return read_file(tree / index_file_name); }
    static std::uint32_t version(const fs::path& tree) { return version_of_index(index(tree), tree); }

    // Does the same to a tree of today and to one of version 3, which has the same chunks.
    void expect_same(const std::function<void(const fs::path& tree)>& change)
    {
        const fs::path today = folder_ / "today.pct", old = folder_ / "old.pct";
        for (const fs::path& tree : {today, old}) {
            fs::remove_all(tree);
            build(surface(20000, 0, 0, 50, 31), tree, Sampling::poisson);
        }
        ASSERT_EQ(index(today), index(old));
        write_file(old / index_file_name, index_of_version_3(decode_index(index(old), "index")));
        ASSERT_EQ(version(old), 3u);
        ASSERT_EQ(Tree::open(old)->nodes().size(), Tree::open(today)->nodes().size());
        ASSERT_TRUE(verify_tree(old, 1).faults.empty());
        for (const fs::path& tree : {today, old}) change(tree);
        EXPECT_EQ(version(today), index_version);
        EXPECT_EQ(version(old), index_version);
        EXPECT_EQ(index(today), index(old));
        EXPECT_TRUE(verify_tree(old, 1).faults.empty());
    }

    const TemporaryFolder folder_;
};

TEST_F(Version3, EveryUpdateWritesAnIndexOfToday)
{
    expect_same([](const fs::path& tree) { append(tree, surface(5000, 30, 20, 50, 32)); });
    expect_same([](const fs::path& tree) { compact_tree(tree); });
    expect_same([](const fs::path& tree) {
        Selection selection;
        selection.box = Tree::open(tree)->info().bounds();
        selection.box->max[0] -= 30;
        EXPECT_GT(erase_points(tree, selection).points_deleted, 0u);
    });
    expect_same([](const fs::path& tree) {
        fs::remove(tree / index_file_name);
        EXPECT_TRUE(repair_tree(tree).index_written);
    });
}

// Opened and drawn as long as nobody looks at that page; repaired, it is the index of before.
TEST(IndexPages, ADamagedOneIsRepairedFromTheChunks)
{
    const TemporaryFolder folder;
    const fs::path tree = folder / "tree.pct", path = tree / index_file_name;
    build(surface(20000, 0, 0, 50, 31), tree, Sampling::poisson);
    const std::vector<std::byte> before = read_file(path);
    TreeIndex index = decode_index(before, path);
    index.pages = pages_of(2, index.nodes.size());
    std::vector<std::byte> damaged = encode_index(index);
    damaged[damaged.size() - 20] ^= std::byte{1};
    write_file(path, damaged);
    EXPECT_NO_THROW(Tree::open(tree));
    EXPECT_THROW(append(tree, surface(10, 0, 0, 50, 32)), Error);
    EXPECT_EQ(read_file(path), damaged);
    const RepairReport report = repair_tree(tree);
    EXPECT_TRUE(report.index_written);
    EXPECT_EQ(report.points_lost, 0u);
    EXPECT_EQ(read_file(path), before);
    EXPECT_EQ(read_file(tree / damaged_index_name), damaged);
    EXPECT_TRUE(verify_tree(tree, 1).faults.empty());
}

TEST_F(Version3, ACopyStaysAsItIs)
{
    const fs::path tree = folder_ / "old.pct", copy = folder_ / "copy.pct";
    build(surface(20000, 0, 0, 50, 31), tree, Sampling::poisson);
    write_file(tree / index_file_name, index_of_version_3(decode_index(index(tree), "index")));
    clone_tree(tree, copy);
    EXPECT_EQ(version(copy), 3u);
    EXPECT_EQ(index(copy), index(tree));
    EXPECT_TRUE(verify_tree(copy, 1).faults.empty());
}

}  // namespace
