// How a cloud is divided for a search.

#include "pcm/detect/sample_units.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

class SampleUnitsTest : public testing::Test {
protected:
    SampleUnitsTest()
    {
        Dice dice(8);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 500000; ++i) points.push_back({{dice.between(0, 10), dice.between(0, 10), 0}, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    static std::size_t holders(const std::vector<Box3i>& units, const Vec3i& q)
    {
        std::size_t count = 0;
        for (const Box3i& unit : units) count += unit.contains(q);
        return count;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

TEST_F(SampleUnitsTest, HoldEachPointOnceAndAboutAsManyAsWereAskedFor)
{
    const ChosenPoints chosen(tree_, {});
    const SampleUnits units(chosen, 1);
    for (const std::vector<Box3i>& boxes :
         {units.with_points(20000), units.with_cell(0), units.with_cell(0.001), units.with_cell(0.5)})
        for (const PlacedPoint& p : all_points(*tree_)) {
            if (p.number % 97 != 0) continue;
            const Vec3i q = tree_->read_chunk(p.node, ColumnSet::only_positions()).positions->grid(p.number);
            ASSERT_EQ(holders(boxes, q), 1u);
        }
    EXPECT_GE(units.with_points(20000).size(), 25u);
    EXPECT_GE(units.with_cell(0.001).size(), 3u);  // maximum 200,000 points
    EXPECT_EQ(units.with_cell(0.5).size(), 1u);    // 400 cells
}

TEST_F(SampleUnitsTest, AreLargerWhereFewPointsAreLeft)
{
    const ChosenPoints chosen(tree_, {});
    const SampleUnits all(chosen, 1), few(chosen, 0.1);
    EXPECT_GT(all.with_points(20000).size(), 5 * few.with_points(20000).size());
    EXPECT_EQ(few.with_cell(0.001).size(), 1u);
}

TEST_F(SampleUnitsTest, HaveTheLevelOfTheirCells)
{
    const ChosenPoints chosen(tree_, {});
    const SampleUnits units(chosen, 1);
    const std::vector<double>& spacings = tree_->info().spacings;
    EXPECT_EQ(units.level_of(0), tree_->info().levels - 1);
    EXPECT_EQ(units.level_of(2 * spacings[0]), 0);
    EXPECT_EQ(units.level_of(1.01 * spacings[1]), 1);
    EXPECT_EQ(units.level_of(0.99 * spacings[1]), 2);
}

TEST_F(SampleUnitsTest, AreThoseOfTheSelection)
{
    Selection half;
    half.box = Box3d{{0, 0, -1}, {10, 2, 1}};
    const ChosenPoints chosen(tree_, half);
    EXPECT_LT(2 * SampleUnits(chosen, 1).with_points(20000).size(),
              SampleUnits(ChosenPoints(tree_, {}), 1).with_points(20000).size());
}

}  // namespace
