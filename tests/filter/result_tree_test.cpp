#include "pcm/filter/result_tree.h"

#include "pcm/filter/voxel_grid.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_lock.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/tree/verify.h"
#include "pcm/tree/verify_levels.h"

#include "tests/filter/voxel_oracle.h"
#include "tests/support.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class ResultTree : public testing::Test {
protected:
    ResultTree()
    {
        Schema schema;
        schema.add({"intensity", ScalarType::u16, 1, 1, 0, {}});
        cloud_ = random_cloud(schema, Grid{{0.001, 0.001, 0.001}, {5e5, 4.8e6, 0}}, 30000, 1, 10);
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        MemoryReader reader(cloud_);
        build_tree(reader, {"one.las", "two.las"}, tree(), options);
        voxels_.voxels.size = 1;
        to_.memory_bytes = 128 << 20;
        to_.chunk_points = 1000;
    }
    fs::path tree() const { return folder_ / "cloud.pct"; }
    std::size_t expected() const { return voxels_of(cloud_, voxels_.voxels).size(); }
    ErrorCode code_of_grid()
    {
        try {
            voxel_grid(tree(), voxels_, to_);
        } catch (const Error& error) {
            message_ = error.what();
            return error.code();
        }
        ADD_FAILURE() << "no error";
        return ErrorCode::io;
    }
    TemporaryFolder folder_;
    MemoryCloud cloud_;
    VoxelGridOptions voxels_;
    ResultOptions to_;
    std::string message_;
};

TEST_F(ResultTree, ANewTreeLeavesTheOldOne)
{
    const std::uint64_t before = Tree::open(tree())->info().content_hash;
    to_.target.copy = folder_ / "grid.pct";
    const VoxelGridReport report = voxel_grid(tree(), voxels_, to_);
    EXPECT_EQ(report.build.outcome.points_in, 30000u);
    EXPECT_EQ(report.build.outcome.points_out, expected());
    EXPECT_LT(report.build.outcome.error, 1e-15);  // coordinates near 0, among millions
    EXPECT_GT(report.most_in_one, 1u);
    const auto made = Tree::open(folder_ / "grid.pct");
    EXPECT_EQ(made->info().points, expected());
    EXPECT_EQ(made->info().sources, (std::vector<std::string>{"one.las", "two.las"}));
    EXPECT_TRUE(verify_tree(folder_ / "grid.pct", 1).faults.empty());
    EXPECT_TRUE(verify_levels(*made, 1).faults.empty());
    EXPECT_EQ(Tree::open(tree())->info().content_hash, before);
    EXPECT_EQ(code_of_grid(), ErrorCode::exists);
    to_.target.overwrite = true;
    voxels_.voxels.size = 2;
    EXPECT_EQ(voxel_grid(tree(), voxels_, to_).build.outcome.points_out, expected());
}

TEST_F(ResultTree, InPlaceReplacesTheTreeAndKeepsOpenOnesReadable)
{
    const auto old = Tree::open(tree());
    to_.target.in_place = true;
    const VoxelGridReport report = voxel_grid(tree(), voxels_, to_);
    EXPECT_EQ(Tree::open(tree())->info().points, expected());
    EXPECT_EQ(report.build.outcome.points_in, 30000u);
    TreeReader reader(old, std::nullopt, {});
    EXPECT_EQ(read_all(reader).points.size, 30000u);
    // Once more: it is one point a voxel already.
    EXPECT_EQ(voxel_grid(tree(), voxels_, to_).build.outcome.points_out, report.build.outcome.points_out);
}

TEST_F(ResultTree, TheTargetMustBeClear)
{
    EXPECT_EQ(code_of_grid(), ErrorCode::invalid_argument);
    EXPECT_NE(message_.find("no output is given"), std::string::npos) << message_;
    to_.target = {folder_ / "grid.pct", true};
    EXPECT_EQ(code_of_grid(), ErrorCode::invalid_argument);
    EXPECT_NE(message_.find("choose one of the two"), std::string::npos) << message_;
    to_.target = {tree(), false};
    to_.target.overwrite = true;
    EXPECT_EQ(code_of_grid(), ErrorCode::invalid_argument);
    EXPECT_NE(message_.find("the output is the input tree"), std::string::npos) << message_;
    to_.target = {"", true};
    to_.memory_bytes = 1 << 20;
    EXPECT_EQ(code_of_grid(), ErrorCode::invalid_argument);
    to_.memory_bytes = 64 << 20;
    {
        const TreeLock lock(tree());
        EXPECT_EQ(code_of_grid(), ErrorCode::exists);
    }
    EXPECT_EQ(Tree::open(tree())->info().points, 30000u);
}

TEST_F(ResultTree, ACancelLeavesTheTreeAndNothingElse)
{
    for (const bool in_place : {false, true})
        for (const double at : {0.0, 0.2, 0.6, 0.9}) {
            to_.target = in_place ? TargetChoice{"", true} : TargetChoice{folder_ / "grid.pct", false};
            to_.progress = [at](const ProgressUpdate& update) { return update.fraction < at; };
            EXPECT_EQ(code_of_grid(), ErrorCode::cancelled);
            EXPECT_EQ(Tree::open(tree())->info().points, 30000u);
            EXPECT_TRUE(verify_tree(tree(), 1).faults.empty());
            std::size_t entries = 0;
            for (const auto& entry : fs::directory_iterator(folder_.path())) entries += entry.exists();
            EXPECT_EQ(entries, 1u) << "something is left, cancelled at " << at;
        }
}

}  // namespace
