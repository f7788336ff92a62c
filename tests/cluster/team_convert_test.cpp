// What several ranks convert is what one process converts, byte for byte. The ranks are threads here.

#include "pcm/cluster/filter/team_convert.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
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

class TeamConvert : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 450'000, 6), {});  // three jobs
        build_tree({folder_ / "in.las"}, tree_, small_chunks());
    }
    ConvertReport team(unsigned ranks, const fs::path& output, const ConvertOptions& options)
    {
        ThreadTeams teams(ranks);
        ConvertReport report;
        const std::vector<std::byte> request(3, std::byte(options.cloud.selection.where.size()));
        teams.run([&](Team& rank) {
            ConvertReport mine = convert_by(rank, {tree_}, output, options, request);
            if (rank.rank() == 0) report = std::move(mine);
        });
        return report;
    }
    static std::string bytes(const fs::path& path)
    {
        std::ifstream file(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    }
    void expect_same(const std::string& extension, const ConvertOptions& options)
    {
        SCOPED_TRACE(extension);
        const fs::path one = folder_ / ("one." + extension), by_team = folder_ / ("team." + extension);
        const ConvertReport expected = convert({tree_}, one, options);
        EXPECT_GT(expected.outcome.points_out, 0u);
        for (const unsigned ranks : {1u, 2u, 5u}) {
            SCOPED_TRACE(ranks);
            const ConvertReport report = team(ranks, by_team, options);
            if (extension == "pct")
                EXPECT_TRUE(contents(by_team) == contents(one));
            else
                EXPECT_TRUE(bytes(by_team) == bytes(one));
            EXPECT_EQ(report.outcome.points_in, expected.outcome.points_in);
            EXPECT_EQ(report.outcome.points_out, expected.outcome.points_out);
            EXPECT_EQ(report.notes, expected.notes);
            fs::remove_all(by_team);
        }
        fs::remove_all(one);
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
    }

    TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "tree.pct";
};

TEST_F(TeamConvert, PointsThatMeetConditions)
{
    ConvertOptions options;
    options.cloud.selection.where = {parse_condition("intensity>20000")};
    for (const char* extension : {"las", "ply", "xyz", "pct"}) expect_same(extension, options);
}

TEST_F(TeamConvert, ABoxOfALevelWithSomeAttributes)
{
    ConvertOptions options;
    options.cloud.level = std::uint16_t(2);
    options.cloud.selection.keep = {"intensity"};
    expect_same("ply", options);
    options.cloud.level.reset();
    const auto tree = Tree::open(tree_);
    Box3d box = tree->info().bounds();
    box.max[0] = 0.5 * (box.min[0] + box.max[0]);
    options.cloud.selection.box = box;
    expect_same("las", options);
}

TEST_F(TeamConvert, RefusesBeforeItReads)
{
    ConvertOptions options;
    std::ofstream(folder_ / "there.las") << "here already";
    EXPECT_THROW(team(2, folder_ / "there.las", options), Error);
    options.write.decimals = 2;
    EXPECT_THROW(team(2, folder_ / "new.las", options), Error);
    options.write.decimals.reset();
    try {
        ThreadTeams(2).run(
            [&](Team& rank) { convert_by(rank, {folder_ / "in.las"}, folder_ / "new.ply", options, {}); });
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
    }
    options.cloud.selection.where = {parse_condition("intensity>65535")};
    EXPECT_THROW(team(2, folder_ / "new.las", options), Error);  // no point
    EXPECT_FALSE(fs::exists(folder_ / "new.las"));
}

TEST_F(TeamConvert, ARankThatFailsLeavesNothingAndTheNextTeamResumes)
{
    ConvertOptions options;
    options.cloud.selection.where = {parse_condition("intensity>20000")};
    convert({tree_}, folder_ / "one.las", options);
    ConvertOptions failing = options;
    failing.progress = [](const ProgressUpdate& update) -> bool {
        if (update.fraction > 0.65) throw Error(ErrorCode::io, "new.las", "the disk is gone");
        return true;
    };
    EXPECT_THROW(team(1, folder_ / "new.las", failing), Error);
    EXPECT_FALSE(fs::exists(folder_ / "new.las"));
    const ConvertReport report = team(3, folder_ / "new.las", options);
    ASSERT_FALSE(report.notes.empty());
    EXPECT_EQ(report.notes.back(), "interrupted work was resumed");
    EXPECT_TRUE(bytes(folder_ / "new.las") == bytes(folder_ / "one.las"));
}

}  // namespace
}  // namespace pcm
