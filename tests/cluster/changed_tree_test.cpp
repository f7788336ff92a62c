// A tree that another program changes while a team works on it: at every step of the work, the result is refused.

#include "pcm/build/builder.h"
#include "pcm/cluster/filter/team_attributes.h"
#include "pcm/cluster/filter/team_convert.h"
#include "pcm/cluster/filter/team_outliers.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/system/error.h"
#include "pcm/tree/verify.h"
#include "pcm/update/clone.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/cluster/counting_team.h"
#include "tests/support.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using namespace test;
namespace fs = std::filesystem;

class ChangedTree : public testing::Test {
protected:
    using Work = std::function<void(Team& team)>;

    void SetUp() override { build(whole_, records(Shape::surface, 6'000, 6), 1000); }

    void build(const fs::path& tree, const std::vector<LasRecord>& points, std::uint32_t chunk_points)
    {
        write_las(folder_ / "in.las", points, {});
        BuildOptions options = small_chunks(chunk_points);
        options.overwrite = true;
        build_tree({folder_ / "in.las"}, tree, options);
    }
    void replace(const std::vector<LasRecord>& points, std::uint32_t chunk_points)
    {
        build(folder_ / "other.pct", points, chunk_points);
        fs::remove_all(tree_);
        fs::rename(folder_ / "other.pct", tree_);
    }
    void reset()
    {
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            if (entry.path() != whole_) fs::remove_all(entry.path());
        clone_tree(whole_, tree_);
    }
    void add_radii() const
    {
        NeighbourAttributeOptions options = small_units();
        options.wanted = {};
        options.wanted.radius = true;
        compute_neighbour_attributes(tree_, options);
    }
    static NeighbourAttributeOptions small_units()
    {
        NeighbourAttributeOptions options;
        options.wanted.normal = true;
        options.neighbours = 6;
        options.unit_points = 2000;
        options.threads = 1;
        return options;
    }
    // The work as it is, and with the tree changed by `change` before the call `call` of the team.
    std::size_t calls_of(const Work& work)
    {
        reset();
        CountingTeam team;
        work(team);
        return team.calls();
    }
    void expect_refused(const Work& work, std::size_t call, const std::function<void()>& change)
    {
        SCOPED_TRACE("changed before call " + std::to_string(call));
        reset();
        Contents changed;
        CountingTeam team(call, [&] {
            change();
            changed = contents(tree_);
        });
        try {
            work(team);
            ADD_FAILURE() << "nothing was refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::exists);
            EXPECT_NE(std::string(error.what()).find("changed the tree meanwhile"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(tree_.string()), std::string::npos) << error.what();
        }
        EXPECT_TRUE(contents(tree_) == changed);
        for (const fs::path& result : {copy_, file_}) EXPECT_FALSE(fs::exists(result));
    }
    // At each call but the last, when the work is done.
    void expect_refused_at_each_step(const Work& work)
    {
        const std::size_t calls = calls_of(work);
        ASSERT_GT(calls, 4u);
        for (std::size_t call = 0; call + 1 < calls; ++call) expect_refused(work, call, [&] { add_radii(); });
        EXPECT_TRUE(verify_tree(tree_).faults.empty());
        SoloTeam again;
        work(again);  // on the tree as it is now
    }

    TemporaryFolder folder_;
    const fs::path whole_ = folder_ / "whole.pct", tree_ = folder_ / "tree.pct", copy_ = folder_ / "copy.pct",
                   file_ = folder_ / "part.las";
};

TEST_F(ChangedTree, IsRefusedByNormalsInPlace)
{
    expect_refused_at_each_step([&](Team& team) {
        compute_neighbour_attributes_by(team, tree_, {{}, true, false}, small_units());
    });
}

TEST_F(ChangedTree, IsRefusedByNormalsOfACopy)
{
    expect_refused_at_each_step([&](Team& team) {
        compute_neighbour_attributes_by(team, tree_, {copy_, false, false}, small_units());
    });
}

TEST_F(ChangedTree, IsRefusedByOutliers)
{
    OutlierOptions options;
    options.neighbours = 4;
    options.factor = 2;
    options.threads = 1;
    expect_refused_at_each_step([&](Team& team) { remove_outliers_by(team, tree_, {{}, true, false}, options); });
    options.count_only = true;
    expect_refused_at_each_step([&](Team& team) { remove_outliers_by(team, tree_, {}, options); });
}

TEST_F(ChangedTree, IsRefusedByConvert)
{
    ConvertOptions options;
    options.cloud.selection.where = {parse_condition("intensity>20000")};
    expect_refused_at_each_step([&](Team& team) { convert_by(team, {tree_}, file_, options, {}); });
}

// Another tree of the same name has the same generation: of one point with another value, and of other chunks.
TEST_F(ChangedTree, IsRefusedWhereItIsReplaced)
{
    OutlierOptions options;
    options.neighbours = 4;
    options.count_only = true;
    options.threads = 1;
    const Work count = [&](Team& team) { remove_outliers_by(team, tree_, {}, options); };
    const std::size_t calls = calls_of(count);
    const TreeInfo before = Tree::open(whole_)->info();
    auto points = records(Shape::surface, 6'000, 6);
    points[5].intensity = static_cast<std::uint16_t>(points[5].intensity ^ 1);
    expect_refused(count, calls - 2, [&] { replace(points, 1000); });
    const TreeInfo other_value = Tree::open(tree_)->info();
    EXPECT_EQ(other_value.generation, before.generation);
    EXPECT_EQ(other_value.bytes, before.bytes);
    EXPECT_NE(other_value.content_hash, before.content_hash);
    points[5].intensity = static_cast<std::uint16_t>(points[5].intensity ^ 1);
    expect_refused(count, calls - 2, [&] { replace(points, 2000); });
    const TreeInfo other_chunks = Tree::open(tree_)->info();
    EXPECT_EQ(other_chunks.generation, before.generation);
    EXPECT_EQ(other_chunks.content_hash, before.content_hash);
    EXPECT_NE(other_chunks.bytes, before.bytes);
}

}  // namespace
}  // namespace pcm
