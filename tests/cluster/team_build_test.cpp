// Trees that several ranks build are those of one process, byte for byte. The ranks are threads here.

#include "pcm/cluster/team_build.h"

#include "pcm/build/builder.h"
#include "pcm/cluster/team_folder.h"
#include "pcm/system/error.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/sanitizers.h"
#include "tests/support.h"
#include "tests/thread_team.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using namespace test;
namespace fs = std::filesystem;

class TeamBuild : public testing::Test {
protected:
    std::vector<LasRecord> cloud(Shape shape = Shape::surface) const
    {
        return records(shape, tries<std::size_t>(120'000, 30'000), 6);  // some forty bins of chunks of 1000
    }
    BuildReport build(unsigned ranks, const std::vector<fs::path>& inputs, BuildOptions options)
    {
        ThreadTeams team(ranks);
        BuildReport report;
        team.run([&](Team& rank) {
            BuildOptions own = options;
            own.threads = 1 + rank.rank() % 2;
            const BuildReport mine = build_tree_by(rank, inputs, folder_ / "team.pct", own);
            if (rank.rank() == 0) report = mine;
        });
        bytes_exchanged_ = team.bytes_exchanged();
        return report;
    }
    // Trees by teams of several sizes, sampled in both ways.
    void expect_same_tree(const std::vector<fs::path>& inputs)
    {
        for (const Sampling sampling : {Sampling::poisson, Sampling::grid}) {
            BuildOptions options = small_chunks();
            options.sampling = sampling;
            options.overwrite = true;
            options.resume = false;  // no syncs, which would be most of the time
            const BuildReport one = build_tree(inputs, folder_ / "one.pct", options);
            const Contents expected = contents(folder_ / "one.pct");
            for (const unsigned ranks : {1u, 2u, 5u}) {
                const BuildReport report = build(ranks, inputs, options);
                EXPECT_TRUE(contents(folder_ / "team.pct") == expected)
                    << ranks << " ranks, " << (sampling == Sampling::grid ? "by grid" : "by distance");
                EXPECT_EQ(report.nodes, one.nodes);
                EXPECT_EQ(report.outcome.points_in, one.outcome.points_in);
                EXPECT_EQ(report.outcome.points_out, one.outcome.points_out);
                EXPECT_FALSE(fs::exists(folder_ / "team.pct.part"));
            }
        }
    }

    TemporaryFolder folder_;
    std::uint64_t bytes_exchanged_ = 0;
};

TEST_F(TeamBuild, OfOneFile)
{
    for (const Shape shape : {Shape::surface, Shape::volume, Shape::coincident, Shape::duplicates, Shape::clusters}) {
        SCOPED_TRACE(name(shape));
        write_las(folder_ / "in.las", cloud(shape), {});
        expect_same_tree({folder_ / "in.las"});
    }
}

// Half of the points in a ten-thousandth of the area: bins are divided again.
TEST_F(TeamBuild, OfADenseClump)
{
    auto points = cloud();
    for (std::size_t i = 0; i < points.size(); i += 2)
        for (std::int32_t* c : {&points[i].x, &points[i].y, &points[i].z}) *c = *c / 100 + 5000;
    write_las(folder_ / "in.las", points, {});
    expect_same_tree({folder_ / "in.las"});
}

// With one offset for all their integers are kept; with offsets of their own all goes through doubles.
TEST_F(TeamBuild, OfManyTiles)
{
    for (const double apart : {0.0, 0.5}) {
        SCOPED_TRACE(apart);
        const auto points = cloud();
        std::vector<fs::path> tiles;
        constexpr std::size_t count = 60;
        for (std::size_t t = 0; t < count; ++t) {
            tiles.push_back(folder_ / ("tile" + std::to_string(t) + ".las"));
            const double offset = apart * static_cast<double>(t);
            write_las(tiles.back(),
                      {points.begin() + static_cast<std::ptrdiff_t>(points.size() * t / count),
                       points.begin() + static_cast<std::ptrdiff_t>(points.size() * (t + 1) / count)},
                      Grid{{0.01, 0.01, 0.01}, {offset, offset, 0}});
        }
        expect_same_tree(tiles);
    }
}

TEST_F(TeamBuild, OfDoubles)
{
    std::vector<std::array<double, 3>> points;
    for (const LasRecord& p : cloud(Shape::clusters)) points.push_back({p.x / 7.0, p.y / 11.0, p.z / 13.0});
    write_ply(folder_ / "in.ply", points);
    expect_same_tree({folder_ / "in.ply"});
}

TEST_F(TeamBuild, OfFewPointsAndOfNone)
{
    for (const std::size_t points : {0, 1, 900}) {
        SCOPED_TRACE(points);
        write_las(folder_ / "in.las", records(Shape::surface, points, 3), {});
        expect_same_tree({folder_ / "in.las"});
    }
}

// What a rank throws comes out, names the rank, and leaves no tree; the work that was done is used by another team.
TEST_F(TeamBuild, ARankThatFailsEndsTheTeamAndTheNextOneResumes)
{
    write_las(folder_ / "in.las", records(Shape::surface, 30'000, 6), {});
    const std::vector<fs::path> inputs{folder_ / "in.las"};
    build_tree(inputs, folder_ / "one.pct", small_chunks());
    const Contents expected = contents(folder_ / "one.pct");
    unsigned resumed = 0, failed = 0;
    for (const double share : {0.1, 0.45, 0.6, 0.9, 0.96, 1.0}) {
        for (const unsigned failing : {0u, 2u}) {
            SCOPED_TRACE(std::to_string(share) + " in rank " + std::to_string(failing));
            ThreadTeams team(3);
            try {
                team.run([&](Team& rank) {
                    BuildOptions own = small_chunks();
                    if (rank.rank() == failing)
                        own.progress = [&](const ProgressUpdate& update) {
                            if (update.fraction >= share) throw Error(ErrorCode::io, "a.las", "the disk is gone");
                            return true;
                        };
                    build_tree_by(rank, inputs, folder_ / "team.pct", own);
                });
            } catch (const Error& error) {
                ++failed;
                EXPECT_NE(std::string(error.what()).find("rank " + std::to_string(failing)), std::string::npos)
                    << error.what();
                EXPECT_NE(std::string(error.what()).find("a.las"), std::string::npos) << error.what();
                EXPECT_FALSE(fs::exists(folder_ / "team.pct"));
                const BuildReport report = build(2, inputs, small_chunks());
                for (const std::string& note : report.notes) resumed += note == "an interrupted build was resumed";
            }
            EXPECT_TRUE(contents(folder_ / "team.pct") == expected);
            fs::remove_all(folder_ / "team.pct");
        }
    }
    EXPECT_GT(failed, 5u);
    EXPECT_EQ(resumed, failed);
}

// Another build's work is not taken.
TEST_F(TeamBuild, OfOtherFilesStartsAgain)
{
    write_las(folder_ / "a.las", cloud(), {});
    write_las(folder_ / "b.las", cloud(Shape::volume), {});
    BuildOptions options = small_chunks();
    options.progress = [](const ProgressUpdate& update) { return update.fraction < 0.6; };
    EXPECT_THROW(build(2, {folder_ / "a.las"}, options), Error);
    EXPECT_TRUE(was_begun_by_team(folder_ / "team.pct"));
    build_tree({folder_ / "b.las"}, folder_ / "one.pct", small_chunks());
    build(2, {folder_ / "b.las"}, small_chunks());
    EXPECT_TRUE(contents(folder_ / "team.pct") == contents(folder_ / "one.pct"));
    EXPECT_THROW(build(2, {folder_ / "b.las"}, small_chunks()), Error);  // it exists
}

}  // namespace
}  // namespace pcm
