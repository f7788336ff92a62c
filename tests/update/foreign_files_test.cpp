// Updates of trees in whose folder links and other things wait where files are written, and of trees behind links.

#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/tree_index.h"
#include "pcm/update/append.h"
#include "pcm/update/clone.h"
#include "pcm/update/compact.h"
#include "pcm/update/erase.h"
#include "pcm/update/repair.h"
#include "tests/sanitizers.h"
#include "tests/update/model.h"

#include <sys/stat.h>

#include <fstream>
#include <functional>
#include <iterator>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class ForeignFilesOfUpdates : public testing::Test {
protected:
    ForeignFilesOfUpdates() { build(surface(5000, 0, 0, 50, 7), tree_); }

    void append()
    {
        const MemoryCloud more = surface(300, 0, 0, 50, 8);
        MemoryReader reader(more);
        AppendOptions options;
        options.memory_bytes = 64 << 20;
        append_points(tree_, reader, {"second.las"}, options);
    }
    void erase()
    {
        Selection selection;
        selection.where.push_back(parse_condition("classification = 0"));
        erase_points(tree_, selection);
    }
    void set()
    {
        const auto cloud = PointCloud::open(tree_, {}, Access::write);
        auto cursor = cloud->edit({});
        for (EditView view; cursor.getNextData(view);) view.mark_written();
        cloud->close();
    }
    void compact(const fs::path& output = {}, bool overwrite = false)
    {
        CompactOptions options;
        options.memory_bytes = 64 << 20;
        options.output = output;
        options.overwrite = overwrite;
        compact_tree(tree_, options);
    }
    const std::vector<std::function<void()>> updates_{[this] { append(); }, [this] { erase(); }, [this] { set(); },
                                                      [this] { compact(); }, [this] { repair_tree(tree_); }};

    // Whatever happens, the file outside the tree stays.
    void expect_precious(const std::function<void()>& update) const
    {
        std::ofstream(folder_ / "other") << "precious";
        try {
            update();
        } catch (const Error&) {
        }
        std::ifstream file(folder_ / "other");
        EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "precious");
        EXPECT_FALSE(fs::exists(folder_ / "made"));
        EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
    }

    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "tree.pct";
};

// Not under the thread sanitizer: a hundred updates, whose threads other tests watch.
TEST_F(ForeignFilesOfUpdates, PCM_NOT_UNDER_THREAD(NothingIsWrittenThroughALinkInTheFolder))
{
    for (const char* name :
         {"lock", "about.pct.new", "index.pct.new", "chunks-001.bpc", "chunks-002.bpc", "update.tmp"})
        for (const char* target : {"../other", "../made"})
            for (std::size_t i = 0; i < updates_.size(); ++i) {
                SCOPED_TRACE(std::string(name) + " to " + target + ", update " + std::to_string(i));
                build(surface(5000, 0, 0, 50, 7), tree_);
                fs::remove(tree_ / name);
                fs::create_symlink(target, tree_ / name);
                expect_precious(updates_[i]);
                fs::remove(tree_ / name);
            }
    // The repair of a lost index, and of a lost about.pct.
    for (const char* lost : {"index.pct", "about.pct"}) {
        SCOPED_TRACE(lost);
        fs::remove(tree_ / lost);
        fs::create_symlink("../other", tree_ / (std::string(lost) + ".new"));
        expect_precious([&] { repair_tree(tree_); });
        EXPECT_FALSE(fs::is_symlink(tree_ / lost));
    }
}

TEST_F(ForeignFilesOfUpdates, ScratchFilesAreNotPutBehindALink)
{
    fs::create_directory(folder_ / "other");
    fs::create_directory_symlink("../other", tree_ / "update.tmp");
    append();
    EXPECT_TRUE(fs::is_empty(folder_ / "other"));
    EXPECT_FALSE(fs::exists(fs::symlink_status(tree_ / "update.tmp")));
}

TEST_F(ForeignFilesOfUpdates, ATreeBehindALinkIsCompactedWhereItIs)
{
    erase();
    fs::create_directory(folder_ / "disk");
    fs::rename(tree_, folder_ / "disk/real.pct");
    fs::create_directory_symlink("disk/real.pct", tree_);
    const auto rows = rows_of(*Tree::open(tree_));
    append();
    EXPECT_EQ(Tree::open(folder_ / "disk/real.pct")->info().points, rows.size() + 300);
    compact();
    EXPECT_TRUE(fs::is_symlink(tree_));
    EXPECT_EQ(Tree::open(folder_ / "disk/real.pct")->info().generation, 1u);
    EXPECT_EQ(Tree::open(tree_)->info().points, rows.size() + 300);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "disk"), fs::directory_iterator()), 1);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 2);
}

TEST_F(ForeignFilesOfUpdates, ATreeIsCompactedFromInside)
{
    erase();
    const std::uint64_t points = Tree::open(tree_)->info().points;
    const fs::path before = fs::current_path();
    for (const char* name : {".", "index.pct", "chunks-000.bpc"}) {
        fs::current_path(tree_);
        CompactOptions options;
        options.memory_bytes = 64 << 20;
        compact_tree(name, options);
        fs::current_path(before);
        EXPECT_EQ(Tree::open(tree_)->info().generation, 1u);
        EXPECT_EQ(Tree::open(tree_)->info().points, points);
        EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
    }
}

TEST_F(ForeignFilesOfUpdates, ATreeWithAUsersFileIsNotReplaced)
{
    std::ofstream(tree_ / "notes.txt") << "precious";
    try {
        compact();
        ADD_FAILURE() << "compacted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::exists);
        EXPECT_NE(std::string(error.what()).find("notes.txt"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(fs::exists(tree_ / "notes.txt"));
    append();
    fs::remove(tree_ / "notes.txt");
    compact();
    EXPECT_FALSE(fs::exists(folder_ / "tree.pct.part"));
}

TEST_F(ForeignFilesOfUpdates, CopiesAreNotPutIntoATree)
{
    for (const fs::path& output : {tree_ / "index.pct", tree_ / "copy.pct", tree_ / "chunks-000.bpc"})
        for (const bool overwrite : {false, true}) {
            EXPECT_THROW(compact(output, overwrite), Error) << output;
            EXPECT_THROW(clone_tree(tree_, output), Error) << output;
        }
    EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
    EXPECT_TRUE(verify_tree(tree_, 1).notes.empty());
}

TEST_F(ForeignFilesOfUpdates, ACopyOfATreeWithADataFileElsewhereIsWhole)
{
    fs::create_directory(folder_ / "disk");
    fs::rename(tree_ / "chunks-000.bpc", folder_ / "disk/chunks-000.bpc");
    fs::create_symlink("../disk/chunks-000.bpc", tree_ / "chunks-000.bpc");
    fs::create_directory(folder_ / "other");
    clone_tree(tree_, folder_ / "other/copy.pct");
    EXPECT_TRUE(verify_tree(folder_ / "other/copy.pct", 1).faults.empty());
    fs::create_directory(folder_ / "slash");
    clone_tree(tree_, folder_ / "slash/copy.pct/");
    EXPECT_TRUE(verify_tree(folder_ / "slash/copy.pct", 1).faults.empty());
}

TEST_F(ForeignFilesOfUpdates, RepairReplacesWhatIsNoFile)
{
    const std::uint64_t points = Tree::open(tree_)->info().points;
    const fs::path index = tree_ / index_file_name;
    const std::function<void()> puts[] = {[&] { ASSERT_EQ(mkfifo(index.c_str(), 0666), 0); },
                                          [&] { fs::create_symlink("nothing", index); },
                                          [&] {  // what an output of this name once did
                                              fs::create_directory(index);
                                              std::ofstream(index / "kept") << "kept";
                                          }};
    for (const auto& put : puts) {
        fs::remove(index);
        put();
        EXPECT_FALSE(repair_tree(tree_, {true, 1, {}}).whole());
        EXPECT_EQ(repair_tree(tree_).outcome.points_out, points);
        EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
    }
    EXPECT_TRUE(fs::exists(tree_ / damaged_index_name / "kept"));
    fs::remove(tree_ / about_file_name);
    ASSERT_EQ(mkfifo((tree_ / about_file_name).c_str(), 0666), 0);
    repair_tree(tree_);
    EXPECT_EQ(read_about(tree_).points, points);
    fs::remove(tree_ / "chunks-000.bpc");
    ASSERT_EQ(mkfifo((tree_ / "chunks-000.bpc").c_str(), 0666), 0);
    EXPECT_THROW(repair_tree(tree_), Error);  // no chunk is left
}

}  // namespace
