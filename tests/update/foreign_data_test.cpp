// Data files of another tree in a tree's folder: never read as the tree's, never removed, and named with the way out.

#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/update/append.h"
#include "pcm/update/erase.h"
#include "pcm/update/foreign_files.h"
#include "pcm/update/repair.h"
#include "tests/update/model.h"

#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class ForeignData : public testing::Test {
protected:
    // Two generations of a tree; another of the same grid and attributes, and one of another grid.
    void SetUp() override
    {
        build(surface(3000, 0, 0, 20, 1), path_);
        append(path_, surface(2000, 30, 0, 20, 2));
        build(surface(3000, 0, 0, 20, 3), similar_);
        MemoryCloud elsewhere = surface(3000, 0, 0, 20, 4);
        elsewhere.info.grid->offset = {7, 8, 9};
        build(elsewhere, other_);
        rows_ = rows_of(*Tree::open(path_));
        fs::copy(path_, folder_ / "good.pct", fs::copy_options::recursive);
    }
    void restore() const
    {
        fs::remove_all(path_);
        fs::copy(folder_ / "good.pct", path_, fs::copy_options::recursive);
    }
    void put(const fs::path& from, const char* name) const
    {
        fs::copy_file(from, path_ / name, fs::copy_options::overwrite_existing);
    }
    RepairReport repair() const
    {
        RepairOptions options;
        options.threads = 1;
        return repair_tree(path_, options);
    }
    // The repair refuses, and changes nothing.
    void expect_refused(const std::string& when, const std::vector<std::string>& words) const
    {
        SCOPED_TRACE(when);
        std::map<std::string, std::uintmax_t> before;
        for (const auto& entry : fs::directory_iterator(path_))
            before[entry.path().filename()] = entry.is_regular_file() ? entry.file_size() : 0;
        try {
            repair();
            ADD_FAILURE() << "repaired";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::corrupt) << error.what();
            for (const std::string& word : words)
                EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << ": " << error.what();
        }
        for (const auto& [name, bytes] : before)
            if (name != lock_file_name) EXPECT_EQ(fs::file_size(path_ / name), bytes) << name;
    }

    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct", similar_ = folder_ / "similar.pct", other_ = folder_ / "other.pct";
    std::vector<Row> rows_;
};

TEST_F(ForeignData, InPlaceOfTheTreesOwn)
{
    for (const fs::path& from : {similar_, other_}) {
        restore();
        put(from / "chunks-000.bpc", "chunks-000.bpc");
        expect_refused(from.string(), {(path_ / "chunks-000.bpc").string(), "another tree", "put the tree's own back"});
        fs::remove(path_ / index_file_name);
        expect_refused(from.string() + ", without the index", {"chunks-000.bpc", "another tree"});
        // It is moved away: what the other files hold is kept.
        fs::remove(path_ / "chunks-000.bpc");
        EXPECT_GT(repair().points_lost, 0u);
        EXPECT_TRUE(verify_tree(path_, 1).faults.empty());
        EXPECT_EQ(Tree::open(path_)->info().points, 2000u);
    }
}

TEST_F(ForeignData, IndexOrAboutOfAnotherTree)
{
    for (const fs::path& from : {similar_, other_}) {
        restore();
        put(from / index_file_name, index_file_name);
        put(from / about_file_name, about_file_name);
        expect_refused(from.string(), {"another tree", "move both out of the folder, and repair again"});
        fs::remove(path_ / index_file_name);
        if (from == other_) expect_refused("without an index", {about_file_name, "another tree"});
        fs::remove(path_ / about_file_name);
        repair();
        expect_tree(path_, rows_, "from the chunks alone");
    }
}

TEST_F(ForeignData, WithoutIndexAndAboutTheUserSaysWhichFilesBelong)
{
    fs::remove(path_ / index_file_name);
    fs::remove(path_ / about_file_name);
    put(other_ / "chunks-000.bpc", "chunks-000.bpc");
    expect_refused("the first is foreign", {"chunks-000.bpc to one, chunks-001.bpc to another",
                                            "move those that do not belong here out of the folder"});
}

TEST_F(ForeignData, BehindTheTreesOwnTheyStay)
{
    for (const fs::path& from : {similar_, other_}) {
        restore();
        put(from / "chunks-000.bpc", "chunks-002.bpc");
        const auto bytes = fs::file_size(path_ / "chunks-002.bpc");
        const RepairReport report = repair();
        EXPECT_TRUE(report.whole());
        EXPECT_TRUE(report.healed.empty());
        ASSERT_EQ(report.outcome.warnings.size(), 1u);
        EXPECT_NE(report.outcome.warnings[0].find("chunks-002.bpc"), std::string::npos);
        Selection selection;
        selection.where.push_back(parse_condition("classification=1"));
        try {
            erase_points(path_, selection);
            ADD_FAILURE() << "the tree was changed";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::exists);
            EXPECT_NE(std::string(error.what()).find("move it out of the tree's folder"), std::string::npos)
                << error.what();
        }
        EXPECT_EQ(fs::file_size(path_ / "chunks-002.bpc"), bytes);
        expect_tree(path_, rows_, "as it was");
    }
}

// An interrupted update does not leave foreign files: a whole chunk of the next generation, or less than a chunk.
TEST_F(ForeignData, LeftoversAreNoForeignFiles)
{
    const fs::path later = folder_ / "later.pct";
    fs::copy(path_, later, fs::copy_options::recursive);
    Selection selection;
    selection.where.push_back(parse_condition("classification=1"));
    ASSERT_GT(erase_points(later, selection).points_deleted, 0u);
    put(later / "chunks-002.bpc", "chunks-002.bpc");
    EXPECT_TRUE(foreign_data_files(path_, Tree::open(path_)->info(), 2).empty());
    EXPECT_EQ(repair().healed, std::vector<std::string>{"chunks-002.bpc"});
    put(later / "chunks-002.bpc", "chunks-002.bpc");
    fs::resize_file(path_ / "chunks-002.bpc", 20);
    EXPECT_EQ(repair().healed, std::vector<std::string>{"chunks-002.bpc"});
    expect_tree(path_, rows_, "as it was");
}

}  // namespace
