// The voxel grid of points in memory: the same as that of a tree.

#include "pcm/filter/voxel_grid_in_memory.h"

#include "pcm/io/reader.h"
#include "pcm/system/error.h"

#include "tests/filter/voxel_oracle.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;

class VoxelGridInMemory : public testing::Test {
protected:
    VoxelGridReport make(const MemoryCloud& cloud, const VoxelGridOptions& options, const std::string& name)
    {
        ResultOptions result;
        result.target.copy = folder_ / name;
        result.target.overwrite = true;
        result.memory_bytes = 64 << 20;
        result.progress = progress_;
        MemoryReader reader(cloud);
        return voxel_grid_in_memory(reader, {"memory"}, options, result);
    }
    MemoryCloud made(const std::string& name) { return points_of(Tree::open(folder_ / name)); }
    static VoxelGridOptions options_of(double size)
    {
        VoxelGridOptions options;
        options.voxels.size = size;
        options.count = true;
        return options;
    }

    TemporaryFolder folder_;
    ProgressFunction progress_;
};

TEST_F(VoxelGridInMemory, EqualsAMapOfVoxels)
{
    struct Case {
        const char* name;
        std::optional<Grid> grid;
        double extent, size;
        Vec3d anchor;
    };
    const Case cases[] = {
        {"on a grid", Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, 10, 2.5, {0, 0, 0}},
        {"map", Grid{{0.001, 0.001, 0.001}, {500000, 4800000, 100}}, 10, 1.7, {0.5, -3, 1e6}},
        {"doubles", std::nullopt, 1, 0.13, {0, 0, 0}},
        {"one voxel", std::nullopt, 0.4, 10, {-5, -5, -5}},
    };
    std::uint64_t seed = 1;
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        MemoryCloud cloud = random_cloud(all_types(), c.grid, 9000, ++seed, c.extent);
        make_categories(cloud);
        VoxelGridOptions options = options_of(c.size);
        options.voxels.anchor = c.anchor;
        const VoxelGridReport report = make(cloud, options, "out.pct");
        expect_grid(cloud, made("out.pct"), options.voxels);
        EXPECT_EQ(report.build.outcome.points_in, 9000u);
        EXPECT_EQ(report.build.outcome.points_out, voxels_of(cloud, options.voxels).size());
    }
}

// Points as they are, on their grid.
TEST_F(VoxelGridInMemory, NearestKeepsPointsAndTheirGrid)
{
    const Grid grid{{0.001, 0.001, 0.001}, {500000, 4800000, 100}};
    MemoryCloud cloud = random_cloud(all_types(), grid, 5000, 3, 10);
    VoxelGridOptions options = options_of(2);
    options.point = VoxelPoint::nearest;
    make(cloud, options, "out.pct");
    const MemoryCloud found = made("out.pct");
    ASSERT_TRUE(found.info.grid);
    EXPECT_EQ(*found.info.grid, grid);
    expect_nearest(cloud, found, options.voxels);
}

TEST_F(VoxelGridInMemory, PointsWithoutAPositionAreLeftOutAndCounted)
{
    MemoryCloud cloud = random_cloud(all_types(), std::nullopt, 2000, 3, 10);
    make_categories(cloud);
    MemoryCloud finite = cloud;
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < 2000; ++i)
        if (i % 7 == 3)
            cloud.points.xyz[i % 3][i] =
                i % 2 ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
        else
            kept.push_back(i);
    keep_points(finite.points, kept);
    const VoxelGridReport report = make(cloud, options_of(2), "out.pct");
    expect_grid(finite, made("out.pct"), options_of(2).voxels);
    EXPECT_EQ(report.build.outcome.points_in, kept.size());
    bool said = false;
    for (const std::string& note : report.build.notes)
        said = said || note == std::to_string(2000 - kept.size()) + " points without a finite position were left out";
    EXPECT_TRUE(said);
}

// A file needs two passes of the result where its format needs to know the box first.
TEST_F(VoxelGridInMemory, WritesFiles)
{
    MemoryCloud cloud = random_cloud(all_types(), Grid{{0.001, 0.001, 0.001}, {5e5, 4.8e6, 0}}, 5000, 3, 10);
    make_categories(cloud);
    for (const char* name : {"out.ply", "out.las", "out.bpc"}) {
        SCOPED_TRACE(name);
        const VoxelGridReport report = make(cloud, options_of(2), name);
        const auto reader = open_reader(folder_ / name);
        const MemoryCloud found = read_all(*reader, 1000);
        EXPECT_EQ(found.points.size, voxels_of(cloud, options_of(2).voxels).size());
        EXPECT_EQ(report.build.outcome.points_out, found.points.size);
        EXPECT_GT(report.build.bytes, 0u);
    }
}

TEST_F(VoxelGridInMemory, NoPointsOnePointAndSeveralAtOnePlace)
{
    for (const std::size_t count : {0u, 1u}) {
        MemoryCloud cloud = random_cloud(all_types(), std::nullopt, count, 3, 10);
        const VoxelGridReport report = make(cloud, options_of(1), "out.pct");
        EXPECT_EQ(report.build.outcome.points_out, count);
        EXPECT_EQ(report.most_in_one, count);
    }
    MemoryCloud cloud = random_cloud(all_types(), std::nullopt, 500, 3, 10);
    for (auto& axis : cloud.points.xyz) std::fill(axis.begin(), axis.end(), 0.25);
    EXPECT_EQ(make(cloud, options_of(1), "out.pct").most_in_one, 500u);
}

TEST_F(VoxelGridInMemory, RefusesWhatMakesNoSenseAndCanBeCancelled)
{
    const MemoryCloud cloud = random_cloud(all_types(), std::nullopt, 500, 3, 10);
    EXPECT_THROW(make(cloud, options_of(0), "out.pct"), Error);
    VoxelGridOptions unknown = options_of(1);
    unknown.by_mean = {"no such attribute"};
    EXPECT_THROW(make(cloud, unknown, "out.pct"), Error);
    EXPECT_THROW(make(cloud, options_of(1e-17), "out.pct"), Error) << "voxels below the last bit of doubles";
    progress_ = [](const ProgressUpdate&) { return false; };
    try {
        make(cloud, options_of(1), "out.pct");
        FAIL() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.pct"));
}

TEST(FitsInMemory, TakesHalfOfTheMemory)
{
    FileInfo info;
    info.schema = all_types();
    info.points = 1'000'000;
    std::uint64_t least = 1;
    while (!fits_in_memory(info, least)) least *= 2;
    EXPECT_GE(least, info.points * (24 + info.schema.point_bytes()) * 2);
    EXPECT_LE(least, info.points * (100 + 3 * info.schema.point_bytes()) * 4);
    info.points_known = false;
    EXPECT_FALSE(fits_in_memory(info, least)) << "a file that does not say how many points it has";
}

}  // namespace
