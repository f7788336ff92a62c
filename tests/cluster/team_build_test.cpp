// Trees that several ranks build are those of one process, byte for byte. The ranks are threads here.

#include "pcm/cluster/team_build.h"

#include "pcm/build/builder.h"
#include "pcm/cluster/stages.h"
#include "pcm/cluster/team_folder.h"
#include "pcm/cluster/team_work.h"
#include "pcm/io/reader.h"
#include "pcm/system/error.h"
#include "pcm/system/renamed_error.h"
#include "pcm/tree/source_rounding.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/cluster/counting_team.h"
#include "tests/sanitizers.h"
#include "tests/support.h"
#include "tests/thread_team.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <optional>

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
    // The cloud in slices, each with an offset that differs by `apart` from that of the one before.
    std::vector<fs::path> tiles(const std::vector<LasRecord>& points, double apart) const
    {
        std::vector<fs::path> files;
        constexpr std::size_t count = 60;
        for (std::size_t t = 0; t < count; ++t) {
            files.push_back(folder_ / ("tile" + std::to_string(t) + ".las"));
            const double offset = apart * static_cast<double>(t);
            write_las(files.back(),
                      {points.begin() + static_cast<std::ptrdiff_t>(points.size() * t / count),
                       points.begin() + static_cast<std::ptrdiff_t>(points.size() * (t + 1) / count)},
                      Grid{{0.01, 0.01, 0.01}, {offset, offset, 0}});
        }
        return files;
    }
    BuildReport build(unsigned ranks, const std::vector<fs::path>& inputs, const BuildOptions& options,
                      std::optional<JobCounter> failing = std::nullopt)
    {
        ThreadTeams team(ranks);
        if (failing) team.fail_at(*failing);
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
    // A build that fails when the stage of this counter begins.
    void fail(unsigned ranks, const std::vector<fs::path>& inputs, JobCounter stage, BuildOptions options)
    {
        options.resume = true;
        try {
            build(ranks, inputs, options, stage);
            ADD_FAILURE() << "stage " << stage << " was not reached";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("the disk is gone"), std::string::npos) << error.what();
        }
        EXPECT_FALSE(fs::exists(folder_ / "team.pct"));
    }
    // What a stage has left.
    std::vector<std::string> jobs_of(const char* stage) const
    {
        const fs::path folder = folder_ / "team.pct.part" / "jobs" / stage;
        return fs::exists(folder) ? names_in(folder) : std::vector<std::string>();
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
                EXPECT_EQ(report.outcome.error, one.outcome.error);
                EXPECT_EQ(report.notes, one.notes);
                EXPECT_FALSE(fs::exists(folder_ / "team.pct.part"));
                fs::remove_all(folder_ / "team.pct");
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

// Offsets of their own are whole steps apart: integers are kept.
TEST_F(TeamBuild, OfManyTiles)
{
    for (const double apart : {0.0, 0.37}) {
        SCOPED_TRACE(apart);
        expect_same_tree(tiles(cloud(), apart));
    }
}

// All ranks read them, in batches.
TEST_F(TeamBuild, IntegersOfTilesAreKeptByAllRanks)
{
    fail(2, tiles(cloud(), 0.37), count_bins, small_chunks());
    EXPECT_GE(jobs_of(stage::batches).size(), tries<std::size_t>(21, 10));
    EXPECT_TRUE(jobs_of(stage::spools).empty());
}

// A point does not fit the first tile's grid, though the header promises it: it is read again as doubles. The sample
// before the first reading meets that point, or does not.
TEST_F(TeamBuild, OfTilesOfWhichAHeaderIsWrong)
{
    for (const std::size_t far : {56'000u, 56'009u}) {
        SCOPED_TRACE(far);
        auto points = records(Shape::surface, 70'000, 6);  // half of them are the sample
        points[far].x = std::numeric_limits<std::int32_t>::max();
        const std::vector<fs::path> inputs = tiles(points, 0.37);
        expect_same_tree(inputs);
        fail(3, inputs, count_bins, small_chunks());
        EXPECT_EQ(jobs_of(stage::plan).size(), 1u);
        EXPECT_EQ(jobs_of(stage::batches).empty(), far == 56'000);
        const BuildReport report = build(2, inputs, small_chunks());
        EXPECT_NE(std::find(report.notes.begin(), report.notes.end(), "an interrupted build was resumed"),
                  report.notes.end());
        BuildOptions same = small_chunks();
        same.overwrite = true;
        build_tree(inputs, folder_ / "one.pct", same);
        EXPECT_TRUE(contents(folder_ / "team.pct") == contents(folder_ / "one.pct"));
        fs::remove_all(folder_ / "team.pct");
    }
}

TEST_F(TeamBuild, OfDoubles)
{
    std::vector<std::array<double, 3>> points;
    for (const LasRecord& p : cloud(Shape::clusters)) points.push_back({p.x / 7.0, p.y / 11.0, p.z / 13.0});
    write_ply(folder_ / "in.ply", points);
    expect_same_tree({folder_ / "in.ply"});
}

// Ranges of points: of files of doubles, and of tiles whose grids are half a step apart.
TEST_F(TeamBuild, OfDoublesThatAllRanksRead)
{
    for (const double off : {0.0, 0.005}) {
        SCOPED_TRACE(off);
        std::vector<fs::path> inputs;
        if (off > 0) {
            inputs = tiles(records(Shape::surface, 30'000, 6), off);
        } else {
            const auto points = records(Shape::clusters, 30'000, 6);
            for (std::size_t t = 0; t < 9; ++t) {
                std::vector<std::array<double, 3>> some;
                for (std::size_t i = t; i < points.size(); i += 9)
                    some.push_back({points[i].x / 7.0, points[i].y / 11.0, points[i].z / 13.0});
                if (t % 3 == 1) some[5][t / 3] = std::numeric_limits<double>::quiet_NaN();
                if (t == 4) some.clear();
                inputs.push_back(folder_ / (std::to_string(t) + ".ply"));
                write_ply(inputs.back(), some);
            }
        }
        expect_same_tree(inputs);
        const Contents expected = contents(folder_ / "one.pct");
        fail(3, inputs, off > 0 ? count_spooled : count_bins, small_chunks());
        EXPECT_GT(jobs_of(stage::spools).size(), 4u);
        BuildOptions options = small_chunks();
        options.sampling = Sampling::grid;
        options.memory_bytes *= 2;
        build(2, inputs, options);
        EXPECT_TRUE(contents(folder_ / "team.pct") == expected);
        fs::remove_all(folder_ / "team.pct");
    }
}

// Half of the points in a small part of the space: bins are divided again.
TEST_F(TeamBuild, OfADenseClumpOfDoubles)
{
    auto points = cloud();
    std::vector<fs::path> inputs;
    for (std::size_t t = 0; t < 4; ++t) {
        std::vector<std::array<float, 3>> some;
        for (std::size_t i = t; i < points.size(); i += 4) {
            const float by = i % 8 < 4 ? 1e-4f : 1.f;
            some.push_back({static_cast<float>(points[i].x) * by, static_cast<float>(points[i].y) * by,
                            static_cast<float>(points[i].z) * by});
        }
        inputs.push_back(folder_ / (std::to_string(t) + ".ply"));
        write_ply(inputs.back(), some);
    }
    expect_same_tree(inputs);
}

TEST_F(TeamBuild, OfTextWithDecimals)
{
    const auto points = cloud();
    std::vector<fs::path> inputs;
    for (std::size_t t = 0; t < 5; ++t) {
        inputs.push_back(folder_ / (std::to_string(t) + ".xyz"));
        std::ofstream file(inputs.back());
        for (std::size_t i = t; i < points.size(); i += 5)
            file << points[i].x / 100 << '.' << 10 + i % 80 << ' ' << points[i].y / 100 << ".5 " << points[i].z << ' '
                 << points[i].intensity << '\n';
    }
    expect_same_tree(inputs);
    EXPECT_TRUE(SourceRounding(Tree::open(folder_ / "one.pct")->info()).has_decimals());
    fail(3, inputs, count_bins, small_chunks());
    EXPECT_EQ(jobs_of(stage::spools).size(), 5u);
}

// Whole files a rank, with positions of their own kinds and poses.
TEST_F(TeamBuild, OfE57PtsAndPtxFiles)
{
    std::vector<fs::path> inputs;
    for (const char* name :
         {"e57/bunnyDouble.e57", "pts/bunnyData.pts", "e57/tiny_spherical.e57", "ptx/1.2-with-color.ptx"}) {
        PCM_REQUIRE_SAMPLE(name);
        inputs.push_back(sample(name));
    }
    expect_same_tree(inputs);
    fail(3, inputs, count_bins, small_chunks());
    EXPECT_GT(jobs_of(stage::spools).size(), 1u);
    EXPECT_GT(jobs_of(stage::spooled).size(), 1u);
}

TEST_F(TeamBuild, RefusesPointsThatAreTooFarAway)
{
    std::vector<fs::path> inputs;
    for (const double far : {1.0, 3.4e38}) {
        std::vector<std::array<double, 3>> points;
        for (const LasRecord& p : records(Shape::surface, 5'000, 6)) points.push_back({p.x / 7.0, p.y / 7.0, 0.1});
        points[7][1] = far;
        inputs.push_back(folder_ / (std::to_string(inputs.size()) + ".ply"));
        write_ply(inputs.back(), points);
    }
    const auto message = [&](const auto& work) -> std::string {
        try {
            work();
        } catch (const Error& error) {
            return without_path(error);
        }
        return "nothing was refused";
    };
    const std::string expected = message([&] { build_tree(inputs, folder_ / "one.pct", small_chunks()); });
    const std::string found = message([&] { build(3, inputs, small_chunks()); });
    EXPECT_NE(expected.find("1 of 10,000 points"), std::string::npos) << expected;
    EXPECT_EQ(found.substr(0, 120), expected.substr(0, 120));
    EXPECT_FALSE(fs::exists(folder_ / "team.pct"));
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

// A build that fails at a step is resumed by the same call, also with more ranks.
TEST_F(TeamBuild, EachStepCanBeTheLast)
{
    write_las(folder_ / "in.las", records(Shape::surface, 9'000, 6), {});
    const std::vector<fs::path> inputs{folder_ / "in.las"};
    build_tree(inputs, folder_ / "one.pct", small_chunks());
    const Contents expected = contents(folder_ / "one.pct");
    CountingTeam whole;
    build_tree_by(whole, inputs, folder_ / "team.pct", small_chunks());
    ASSERT_GT(whole.calls(), 30u);
    for (std::size_t call = 0; call < whole.calls(); ++call) {
        SCOPED_TRACE("failed before call " + std::to_string(call));
        fs::remove_all(folder_ / "team.pct");
        CountingTeam team(call, [] { throw Error(ErrorCode::io, {}, "the disk is gone"); });
        EXPECT_THROW(build_tree_by(team, inputs, folder_ / "team.pct", small_chunks()), Error);
        if (call + 1 < whole.calls()) build(1 + call % 3, inputs, small_chunks());
        EXPECT_TRUE(contents(folder_ / "team.pct") == expected);
    }
}

// Rows are given up when they are sorted, sorted bins and their levels when their chunks are built.
TEST_F(TeamBuild, StagesAreGivenUpWhenNothingReadsThem)
{
    for (const bool doubles : {false, true}) {
        SCOPED_TRACE(doubles ? "doubles" : "integers");
        const std::vector<fs::path> inputs = tiles(records(Shape::surface, 70'000, 6), doubles ? 0.005 : 0);
        BuildOptions options = small_chunks();
        options.overwrite = true;
        build_tree(inputs, folder_ / "one.pct", options);
        fail(2, inputs, count_subtrees, small_chunks());
        for (const char* gone :
             {stage::plan, stage::batches, stage::spools, stage::samples, stage::cuts, stage::spooled})
            EXPECT_TRUE(jobs_of(gone).empty()) << gone;
        EXPECT_GT(jobs_of(stage::bins).size(), 10u);
        fail(3, inputs, count_data_files, small_chunks());
        for (const char* gone : {stage::plan, stage::batches, stage::bins, stage::levels})
            EXPECT_TRUE(jobs_of(gone).empty()) << gone;
        EXPECT_GT(jobs_of(stage::subtrees).size(), 1u);
        const BuildReport report = build(2, inputs, small_chunks());
        EXPECT_TRUE(contents(folder_ / "team.pct") == contents(folder_ / "one.pct"));
        EXPECT_GT(report.scratch_bytes, 30'000u);
        fs::remove_all(folder_ / "team.pct");
    }
}

// The stages before have been given up, so that it cannot be made again.
TEST_F(TeamBuild, AFinishedPartThatIsGoneEndsTheBuild)
{
    write_las(folder_ / "in.las", records(Shape::surface, 20'000, 6), {});
    fail(2, {folder_ / "in.las"}, count_subtrees, small_chunks());
    const fs::path bins = folder_ / "team.pct.part" / "jobs" / stage::bins;
    fs::remove(bins / names_in(bins).front());
    try {
        build(2, {folder_ / "in.las"}, small_chunks());
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("is gone"), std::string::npos) << error.what();
        EXPECT_NE(error.hint().find("team.pct.part and start again"), std::string::npos) << error.hint();
    }
    fs::remove_all(folder_ / "team.pct.part");
    build(2, {folder_ / "in.las"}, small_chunks());
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
