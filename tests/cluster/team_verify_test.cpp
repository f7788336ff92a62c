// What several ranks find in a tree is what one process finds. The ranks are threads here.

#include "pcm/cluster/team_verify.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/support.h"
#include "tests/thread_team.h"

#include <gtest/gtest.h>

#include <fstream>

namespace pcm {
namespace {

using namespace test;
namespace fs = std::filesystem;

class TeamVerify : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 200'000, 6), {});
        build_tree({folder_ / "in.las"}, tree_, small_chunks());
    }
    void expect_same_findings(bool intact)
    {
        const VerifyReport one = verify_tree(tree_);
        EXPECT_EQ(one.faults.empty() && one.around.empty(), intact);
        for (const unsigned ranks : {1u, 2u, 5u}) {
            SCOPED_TRACE(ranks);
            ThreadTeams team(ranks);
            std::vector<VerifyReport> reports(ranks);
            team.run([&](Team& rank) { reports[rank.rank()] = verify_tree_by(rank, tree_, 1 + rank.rank() % 2); });
            EXPECT_EQ(reports[0].outcome.points_in, one.outcome.points_in);
            EXPECT_EQ(reports[0].outcome.points_out, one.outcome.points_out);
            EXPECT_EQ(reports[0].bytes, one.bytes);
            EXPECT_EQ(reports[0].notes, one.notes);
            for (const VerifyReport& report : reports) {
                EXPECT_EQ(report.faults, one.faults);
                EXPECT_EQ(report.around, one.around);
            }
        }
    }
    void damage(std::uint64_t at)
    {
        std::fstream file(tree_ / "chunks-000.bpc", std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(at));
        file.write("damaged!", 8);
    }

    TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "tree.pct";
};

TEST_F(TeamVerify, AnIntactTree) { expect_same_findings(true); }

TEST_F(TeamVerify, DamagedChunks)
{
    const std::uint64_t size = fs::file_size(tree_ / "chunks-000.bpc");
    for (const std::uint64_t part : {1u, 4u, 7u}) damage(size * part / 9);
    expect_same_findings(false);
    EXPECT_GE(verify_tree(tree_).faults.size(), 2u);
}

// What rank 0 finds without reading chunks reaches the others.
TEST_F(TeamVerify, FilesAroundTheChunks)
{
    fs::remove(tree_ / "about.pct");
    std::ofstream(tree_ / "notes.txt") << "a stray file";
    expect_same_findings(false);
}

// A point that was changed with its chunk's checksum is found by the sum over all ranks alone.
TEST_F(TeamVerify, ChunksOfAnotherTree)
{
    std::vector<LasRecord> points = records(Shape::surface, 200'000, 6);
    points[170'000].intensity = static_cast<std::uint16_t>(points[170'000].intensity + 1);
    write_las(folder_ / "in.las", points, {});
    build_tree({folder_ / "in.las"}, folder_ / "other.pct", small_chunks());
    ASSERT_EQ(Tree::open(folder_ / "other.pct")->nodes().size(), Tree::open(tree_)->nodes().size());
    fs::copy_file(folder_ / "other.pct" / "chunks-000.bpc", tree_ / "chunks-000.bpc",
                  fs::copy_options::overwrite_existing);
    expect_same_findings(false);
}

TEST_F(TeamVerify, ARankThatFailsIsNamed)
{
    ThreadTeams team(3);
    try {
        team.run([&](Team& rank) {
            verify_tree_by(rank, tree_, 1, [&](const ProgressUpdate&) {
                if (rank.rank() == 2) throw Error(ErrorCode::io, "a.bpc", "the disk is gone");
                return true;
            });
        });
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("a.bpc"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("rank 2"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace pcm
