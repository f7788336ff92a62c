// What several ranks compute for the points of a tree is what one process computes, byte for byte. The ranks are
// threads here.

#include "pcm/cluster/filter/team_attributes.h"
#include "pcm/cluster/filter/team_outliers.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "pcm/tree/verify.h"
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

class TeamFilter : public testing::Test {
protected:
    static constexpr std::uint64_t memory = std::uint64_t(512)
                                            << 20;  // for all values: one process writes them at last

    void build(Shape shape, std::size_t points)
    {
        write_las(folder_ / "in.las", records(shape, points, 6), {});
        BuildOptions options = small_chunks();
        options.overwrite = true;
        build_tree({folder_ / "in.las"}, tree_, options);
    }
    NeighbourAttributeOptions small_units() const
    {
        NeighbourAttributeOptions options;
        options.wanted.normal = options.wanted.confidence = true;
        options.neighbours = 8;
        options.unit_points = 1500;
        options.memory_bytes = memory;
        return options;
    }
    NeighbourAttributeReport team(unsigned ranks, const NeighbourAttributeOptions& options, const TargetChoice& choice)
    {
        ThreadTeams teams(ranks);
        NeighbourAttributeReport report;
        teams.run([&](Team& rank) {
            NeighbourAttributeOptions own = options;
            own.threads = 1 + rank.rank() % 2;
            NeighbourAttributeReport mine = compute_neighbour_attributes_by(rank, tree_, choice, own);
            if (rank.rank() == 0) report = std::move(mine);
        });
        return report;
    }
    void expect_same(const NeighbourAttributeOptions& options)
    {
        fs::remove_all(folder_ / "one.pct");
        UpdateTarget target(tree_, to("one.pct"));
        const NeighbourAttributeReport one =
            target.update([&](const fs::path& folder) { return compute_neighbour_attributes(folder, options); });
        const Contents expected = contents(folder_ / "one.pct");
        for (const unsigned ranks : {1u, 2u, 5u}) {
            SCOPED_TRACE(std::to_string(ranks) + " ranks");
            fs::remove_all(folder_ / "team.pct");
            const NeighbourAttributeReport report = team(ranks, options, to("team.pct"));
            EXPECT_TRUE(contents(folder_ / "team.pct") == expected);
            EXPECT_FALSE(fs::exists(folder_ / "team.pct.part"));
            for (const auto member : {&NeighbourAttributeReport::lines, &NeighbourAttributeReport::blobs,
                                      &NeighbourAttributeReport::too_few, &NeighbourAttributeReport::two_surfaces,
                                      &NeighbourAttributeReport::limited, &NeighbourAttributeReport::flipped})
                EXPECT_EQ(report.*member, one.*member);
            EXPECT_EQ(report.used_known_normals, one.used_known_normals);
            EXPECT_EQ(report.outcome.points_out, one.outcome.points_out);
            EXPECT_EQ(report.notes, one.notes);
        }
        EXPECT_TRUE(verify_tree(folder_ / "team.pct").faults.empty());
    }
    TargetChoice to(const char* name) const { return {folder_ / name, false, false}; }
    void expect_same_outliers(const OutlierOptions& options)
    {
        fs::remove_all(folder_ / "one.pct");
        UpdateTarget target(tree_, to("one.pct"));
        const OutlierReport one =
            target.update([&](const fs::path& folder) { return remove_outliers(folder, options); });
        EXPECT_GT(one.outliers, 0u);
        const Contents expected = contents(folder_ / "one.pct");
        for (const unsigned ranks : {1u, 3u}) {
            SCOPED_TRACE(std::to_string(ranks) + " ranks");
            fs::remove_all(folder_ / "team.pct");
            OutlierReport report;
            ThreadTeams(ranks).run([&](Team& rank) {
                OutlierReport mine = remove_outliers_by(rank, tree_, to("team.pct"), options);
                if (rank.rank() == 0) report = std::move(mine);
            });
            EXPECT_TRUE(contents(folder_ / "team.pct") == expected);
            EXPECT_EQ(report.outliers, one.outliers);
            EXPECT_EQ(report.threshold, one.threshold);
            EXPECT_EQ(report.coverage_kept, one.coverage_kept);
            EXPECT_EQ(report.outcome.points_out, one.outcome.points_out);
        }
    }

    TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "tree.pct";
};

TEST_F(TeamFilter, NormalsOfTheSameSideAlongSurfaces)
{
    for (const Shape shape : {Shape::surface, Shape::volume, Shape::coincident, Shape::duplicates, Shape::clusters}) {
        SCOPED_TRACE(name(shape));
        build(shape, tries<std::size_t>(20'000, 8'000));
        expect_same(small_units());
    }
}

TEST_F(TeamFilter, AllAttributesByADirection)
{
    build(Shape::surface, 20'000);
    NeighbourAttributeOptions options = small_units();
    WantedValues& wanted = options.wanted;
    wanted.radius = wanted.curvature = wanted.mean_distance = true;
    wanted.radius_neighbours = 4;
    options.radius_limit = 1.5;
    options.orientation = {NormalOrientation::Rule::direction, {0.1, 0.2, -1}};
    expect_same(options);
}

// Radii are measured across normals that the tree has, and then take the place of older ones.
TEST_F(TeamFilter, RadiiOfATreeWithNormalsInPlace)
{
    build(Shape::surface, 20'000);
    team(2, small_units(), {{}, true, false});
    EXPECT_FALSE(fs::exists(folder_ / "tree.pct.part"));
    NeighbourAttributeOptions options = small_units();
    options.wanted = {};
    options.wanted.radius = true;
    expect_same(options);
    EXPECT_TRUE(team(2, options, {{}, true, false}).used_known_normals);
    options.neighbours = 5;
    expect_same(options);
}

TEST_F(TeamFilter, OfFewPointsAndOfNone)
{
    for (const std::size_t points : {0, 1, 900}) {
        SCOPED_TRACE(points);
        build(Shape::surface, points);
        expect_same(small_units());
    }
}

TEST_F(TeamFilter, OutliersByEachMethod)
{
    build(Shape::clusters, tries<std::size_t>(230'000, 110'000));  // more than a unit
    OutlierOptions options;
    options.neighbours = 6;
    options.factor = 1.5;
    options.memory_bytes = memory;
    for (const OutlierMethod method : {OutlierMethod::statistical, OutlierMethod::robust}) {
        options.method = method;
        expect_same_outliers(options);
    }
    options.label = true;
    expect_same_outliers(options);
    options.label = false;
    options.method = OutlierMethod::radius;
    options.radius = 0.5;
    expect_same_outliers(options);
    const Contents before = contents(tree_);
    options.count_only = true;
    ThreadTeams(2).run([&](Team& rank) { remove_outliers_by(rank, tree_, {}, options); });
    EXPECT_TRUE(contents(tree_) == before);
    EXPECT_FALSE(fs::exists(folder_ / "tree.pct.part"));
}

// What a rank throws comes out, names the rank, and leaves no tree; the work that was done is used by another team.
TEST_F(TeamFilter, ARankThatFailsEndsTheTeamAndTheNextOneGoesOn)
{
    build(Shape::surface, 30'000);
    const NeighbourAttributeOptions options = small_units();
    UpdateTarget(tree_, to("one.pct")).update([&](const fs::path& folder) {
        return compute_neighbour_attributes(folder, options);
    });
    const Contents expected = contents(folder_ / "one.pct"), before = contents(tree_);
    unsigned failed = 0, resumed = 0;
    for (const double share : {0.0, 0.3, 0.7, 0.76, 0.95}) {
        for (const unsigned failing : {0u, 2u}) {
            SCOPED_TRACE(std::to_string(share) + " in rank " + std::to_string(failing));
            try {
                ThreadTeams(3).run([&](Team& rank) {
                    NeighbourAttributeOptions own = options;
                    own.threads = 1;
                    if (rank.rank() == failing)
                        own.progress = [&](const ProgressUpdate& update) {
                            if (update.fraction >= share) throw Error(ErrorCode::io, "a.bpc", "the disk is gone");
                            return true;
                        };
                    compute_neighbour_attributes_by(rank, tree_, to("team.pct"), own);
                });
            } catch (const Error& error) {
                ++failed;
                EXPECT_NE(std::string(error.what()).find("rank " + std::to_string(failing)), std::string::npos)
                    << error.what();
                EXPECT_NE(std::string(error.what()).find("a.bpc"), std::string::npos) << error.what();
                EXPECT_FALSE(fs::exists(folder_ / "team.pct"));
                const NeighbourAttributeReport report = team(2, options, to("team.pct"));
                for (const std::string& note : report.notes) resumed += note == "interrupted work was resumed";
            }
            EXPECT_TRUE(contents(folder_ / "team.pct") == expected);
            EXPECT_TRUE(contents(tree_) == before);
            fs::remove_all(folder_ / "team.pct");
        }
    }
    EXPECT_GT(failed, 4u);
    EXPECT_EQ(resumed, failed);
}

// Jobs of other options, or of a tree that has changed since, are not taken.
TEST_F(TeamFilter, OfOtherOptionsStartsAgain)
{
    build(Shape::surface, 20'000);
    NeighbourAttributeOptions options = small_units();
    options.progress = [](const ProgressUpdate& update) { return update.fraction < 0.8; };
    EXPECT_THROW(team(1, options, to("team.pct")), Error);
    EXPECT_TRUE(fs::exists(folder_ / "team.pct.part"));
    NeighbourAttributeOptions others = small_units();
    others.neighbours = 9;
    const NeighbourAttributeReport report = team(2, others, to("team.pct"));
    EXPECT_EQ(report.notes.back(), "the remains of interrupted work on something else were removed");
    fs::remove_all(folder_ / "one.pct");
    UpdateTarget(tree_, to("one.pct")).update([&](const fs::path& folder) {
        return compute_neighbour_attributes(folder, others);
    });
    EXPECT_TRUE(contents(folder_ / "team.pct") == contents(folder_ / "one.pct"));
    EXPECT_THROW(team(2, others, to("team.pct")), Error);  // it exists
}

}  // namespace
}  // namespace pcm
