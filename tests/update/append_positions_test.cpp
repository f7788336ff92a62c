// What an append does to positions of a tree of doubles: its decimals, and its grid.

#include "pcm/system/error.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/tree/verify.h"
#include "pcm/update/append.h"
#include "pcm/update/compact.h"
#include "pcm/update/erase.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

MemoryCloud cloud_of(const std::vector<Vec3d>& positions)
{
    MemoryCloud cloud;
    cloud.info.points = positions.size();
    cloud.info.position_type = ScalarType::f64;
    cloud.points.reset({}, false, positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = positions[i][a];
    return cloud;
}

class AppendPositions : public testing::Test {
protected:
    void build(const std::vector<Vec3d>& positions)
    {
        const MemoryCloud cloud = cloud_of(positions);
        MemoryReader reader(cloud);
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        build_tree(reader, {}, path_, options);
    }
    AppendReport append(const std::vector<Vec3d>& positions) const
    {
        const MemoryCloud cloud = cloud_of(positions);
        MemoryReader reader(cloud);
        AppendOptions options;
        options.memory_bytes = 64 << 20;
        return append_points(path_, reader, {}, options);
    }
    std::vector<Vec3d> read() const
    {
        TreeReader reader(Tree::open(path_), std::nullopt, {});
        const MemoryCloud cloud = read_all(reader);
        std::vector<Vec3d> positions;
        for (std::size_t i = 0; i < cloud.points.size; ++i)
            positions.push_back(position_of(cloud.points, std::nullopt, i));
        std::sort(positions.begin(), positions.end());
        return positions;
    }
    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
    const std::vector<Vec3d> decimals_ = {{-0.007, 1, 2}, {0.1, 0.7, 3}, {1000, 1000, 1000}};
};

TEST_F(AppendPositions, DecimalsStayDecimals)
{
    build(decimals_);
    EXPECT_EQ(Tree::open(path_)->info().position_error, 0);
    EXPECT_EQ(append({{0.003, 0.3, 5}}).outcome.error, 0);
    std::vector<Vec3d> all = decimals_;
    all.push_back({0.003, 0.3, 5});
    std::sort(all.begin(), all.end());
    EXPECT_EQ(read(), all);
    compact_tree(path_, {});
    EXPECT_EQ(read(), all);
    EXPECT_TRUE(verify_tree(path_).faults.empty());
}

// Positions that were rounded to decimals no longer are, and a note reports it.
TEST_F(AppendPositions, OtherNumbersEndTheRoundingAndAreNotRoundedThemselves)
{
    build(decimals_);
    const Vec3d third{1.0 / 3, 1.0 / 3, 1.0 / 3};
    const AppendReport report = append({third});
    EXPECT_FALSE(SourceRounding(Tree::open(path_)->info()).has_decimals());
    EXPECT_GT(report.outcome.error, 0);
    EXPECT_LT(report.outcome.error, 1e-15);
    std::vector<Vec3d> all = decimals_;
    all.push_back(third);
    std::sort(all.begin(), all.end());
    const std::vector<Vec3d> after = read();
    ASSERT_EQ(after.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) EXPECT_LE(std::fabs(after[i][a] - all[i][a]), report.outcome.error);
}

// The box that an export or a deletion takes is the box that a query counts.
TEST_F(AppendPositions, ADeletionTakesPointsAtTheFaceOfItsBox)
{
    build(decimals_);
    Selection selection;
    selection.box = Box3d{{-0.007, 0, 0}, {0.05, 10, 10}};
    TreeReader reader(Tree::open(path_), std::nullopt, selection);
    EXPECT_EQ(read_all(reader).points.size, 1u);
    EXPECT_EQ(erase_points(path_, selection).points_deleted, 1u);
}

TEST_F(AppendPositions, ATreeWhoseGridIsTooCoarseForThemTakesNoPoints)
{
    std::vector<Vec3d> large, small;
    for (int i = 0; i < 100; ++i) {
        large.push_back({1e25 * i, 2e25 * (i % 7), 1e24 * i});
        small.push_back({0.1 * i, 0.2 * (i % 7), 0.01 * i});
    }
    build(large);
    const std::uint32_t generation = Tree::open(path_)->info().generation;
    try {
        append(small);
        ADD_FAILURE() << "appended";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("apart"), std::string::npos) << error.what();
    }
    EXPECT_EQ(Tree::open(path_)->info().generation, generation);
    EXPECT_TRUE(verify_tree(path_).faults.empty());
}

TEST_F(AppendPositions, NoDataValuesBeyondTheGridAreRefusedWithTheWayOut)
{
    build(decimals_);
    try {
        append({{1, 2, 3.4e38}});
        ADD_FAILURE() << "appended";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("--largest-coordinate"), std::string::npos) << error.what();
    }
}

}  // namespace
