// Parts of surfaces in the units of an assignment: their numbers, what is kept of them, and which are one.

#include "pcm/detect/unit_parts.h"

#include "pcm/detect/point_labels.h"
#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"

#include <chrono>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

UnitPart part(std::uint32_t number, std::uint64_t points, std::vector<Vec3d> some = {})
{
    UnitPart one;
    one.number = number;
    one.part.hypothesis = 7;
    one.part.points = points;
    one.part.sampled = points / 2;
    one.part.edge = points / 4;
    one.part.continued = points / 8;
    one.part.mixed = points / 16;
    one.part.squares = 0.5 * static_cast<double>(points);
    one.part.smooth_squares = 0.25 * static_cast<double>(points);
    one.part.box.extend(Vec3d{double(number), 0, 0});
    one.part.some = std::move(some);
    return one;
}

TEST(PartNumbers, AreGivenOnceAndRefusedWhereLabelsHaveNoRoom)
{
    PartNumbers numbers(interior_label - 10);
    EXPECT_EQ(numbers.take(4), interior_label - 10);
    const std::uint32_t last = numbers.take(5) + 4;
    EXPECT_EQ((last + 1) & interior_label, 0u);  // its label
    try {
        numbers.take(1);
        FAIL() << "a label with the bit interior_label";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        EXPECT_NE(std::string(error.what()).find("2,147,483,647"), std::string::npos) << error.what();
    }
    EXPECT_THROW(PartNumbers(interior_label).take(0xffffffffu), Error);  // more than 32 bits
}

TEST(UnitParts, AreAddedTogetherInTheOrderOfUnitsAndSmallOnesLeftOut)
{
    UnitParts parts(3);
    parts.add(2, {part(10, 80, {{3, 0, 0}}), part(11, 8)}, {{10, 11}});
    parts.add(0, {part(4, 160, {{1, 0, 0}, {1, 1, 0}}), part(5, 16), part(9, 400)}, {});
    parts.add(0, {part(20, 24, {{2, 0, 0}})}, {});
    BorderCells border;
    border.add({{5, 7, 4}, {6, 7, 5}, {8, 7, 9}});
    border.add({{5, 7, 10}, {8, 6, 5}});
    border.add({{5, 7, 20}});
    const AssignedPoints together = parts.together(border, 100, 60);
    ASSERT_EQ(together.parts.size(), 2u);  // 16 are too few
    const SurfacePart& whole = together.parts[0];
    EXPECT_EQ(whole.hypothesis, 7u);
    EXPECT_EQ(whole.points, 272u);
    EXPECT_EQ(whole.sampled, 136u);
    EXPECT_EQ(whole.edge, 68u);
    EXPECT_EQ(whole.continued, 34u);
    EXPECT_EQ(whole.mixed, 16u);
    EXPECT_EQ(whole.squares, 136);
    EXPECT_EQ(whole.smooth_squares, 68);
    EXPECT_EQ(whole.box.min[0], 4);
    EXPECT_EQ(whole.box.max[0], 20);
    const std::vector<Vec3d> some{{1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {3, 0, 0}};
    EXPECT_EQ(whole.some, some);
    EXPECT_EQ(together.parts[1].points, 400u);
    for (const std::uint32_t number : {4u, 10u, 11u, 20u}) EXPECT_EQ(together.part_of(number + 1), 0u);
    EXPECT_EQ(together.part_of(10), 1u);
    for (const std::uint32_t number : {0u, 5u, 6u, 19u, 21u})
        EXPECT_EQ(together.part_of(number + 1), AssignedPoints::no_part) << number;
}

TEST(UnitParts, BothLeastNumbersCountForTheWhole)
{
    for (const std::uint64_t sampled : {90, 91}) {
        UnitParts parts(1);
        parts.add(0, {part(0, 100), part(1, 80)}, {{0, 1}});
        EXPECT_EQ(parts.together(BorderCells(), 180, sampled).parts.size(), sampled == 90 ? 1u : 0u);
    }
    UnitParts parts(1);
    parts.add(0, {part(0, 100), part(1, 80)}, {{0, 1}});
    EXPECT_EQ(parts.together(BorderCells(), 181, 0).parts.size(), 0u);
}

class ManyParts : public testing::Test {
protected:
    // 900 islands of nine points and a floor, all of one plane, in four units.
    ManyParts()
    {
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 90; ++i)
            for (int k = 0; k < 90; ++k)
                points.push_back({{(i / 3) * 0.4 + 0.02 * (i % 3), (k / 3) * 0.4 + 0.02 * (k % 3), 0}, {}});
        for (int i = 0; i < 100; ++i)
            for (int k = 0; k < 600; ++k) points.push_back({{-3 + 0.02 * i, 0.02 * k, 0}, {}});
        tree_ = build_surface_tree(folder_.path(), points);
        plane_.box = {{-4, -1, 0}, {13, 13, 0}};
        plane_.threshold = 0.01;
        options_.sample = {tree_->info().levels, 0.01, 0.08};
        options_.normal_angle = 0.6;
        options_.reach = 0.1;
        options_.least_points = 500;
        options_.progress = [](double) {};
        for (const Box3i& half : halves_of(tree_->info().box, tree_->info().grid.scale))
            for (const Box3i& quarter : halves_of(half, tree_->info().grid.scale)) units_.push_back(quarter);
    }
    AssignedPoints assign(PointLabels& labels) const
    {
        return assign_points(ChosenPoints(tree_, {}), units_, {plane_}, options_, &labels);
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::vector<Box3i> units_;
    Hypothesis plane_;
    AssignOptions options_;
};

TEST_F(ManyParts, NothingIsKeptOfSmallOnesAwayFromBorders)
{
    PointLabels labels(*tree_);
    const AssignedPoints assigned = assign(labels);
    ASSERT_EQ(assigned.parts.size(), 1u);
    EXPECT_EQ(assigned.parts[0].points, 60000u);
    EXPECT_LE(assigned.numbers.size(), units_.size());  // there were 900
    std::uint64_t floor = 0, islands = 0;
    for (const PlacedPoint& p : all_points(*tree_)) {
        const std::uint32_t label = labels.get(p.node)[p.number] & ~interior_label;
        if (label == 0) continue;
        const bool kept = assigned.part_of(label) == 0;
        EXPECT_EQ(kept, p.position[0] < -0.5);
        ++(kept ? floor : islands);
    }
    EXPECT_EQ(floor, 60000u);
    EXPECT_GT(islands, 4000u);
    options_.least_points = 1;
    EXPECT_GT(assign(labels).numbers.size(), 800u);
}

TEST_F(ManyParts, CancellingIsHeardInsideAUnit)
{
    units_ = {tree_->info().box};
    PointLabels labels(*tree_);
    std::atomic<int> checks{0};
    options_.sample.step = 0.1;
    options_.sample.margin = 0.11;
    options_.sample.check = [&] { ++checks; };
    assign(labels);
    const int all = checks;
    ASSERT_GT(all, 100);  // in addition to those for each node
    checks = 0;
    options_.sample.check = [&] {
        ++checks;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    };
    int reports = 0;
    options_.progress = [&](double) {
        if (++reports == 2) throw Error(ErrorCode::cancelled, {}, "cancelled");
    };
    EXPECT_THROW(assign(labels), Error);
    EXPECT_LT(checks, 50);  // it would be seconds else
}

}  // namespace
