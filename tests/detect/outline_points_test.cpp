// Points within outlines of planes' parts.
#include "pcm/detect/outline_points.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double outline_spacing = 0.05, outline_threshold = 0.008;

// A strip of 300 points with a label, and 100 of each other sort without one.
class OutlinePointsTest : public testing::Test {
protected:
    enum Sort { own, inside, next_to, beyond, above, others, sorts };

    OutlinePointsTest()
    {
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 300; ++i) points.push_back({strip(0, 0.2, 0), {}});
        for (int i = 0; i < 100; ++i) {
            points.push_back({strip(0.02, 0.18, -0.006 * dice_.between(0.1, 1)), {}});
            points.push_back({{dice_.between(0.2, 3.8), dice_.between(-0.03, -0.01), 0}, {}});
            points.push_back({strip(-0.2, -0.1, 0), {}});
            points.push_back({strip(0.02, 0.18, 0.02), {}});
            points.push_back({strip(0.02, 0.18, 0.004), {}});
        }
        sort_of_ = [](const Vec3d& p) {
            if (p[1] < -0.05) return beyond;
            if (p[1] < 0) return next_to;
            if (p[2] > 0.01) return above;
            if (std::fabs(p[2]) < 1e-6) return own;
            return std::fabs(p[2] - 0.004) < 1e-6 ? others : inside;
        };
        tree_ = build_surface_tree(folder_.path(), points);
        assigned_.parts.resize(2);
        assigned_.numbers = {{0, 0}, {1, 1}};
        assigned_.next_number = 2;
        planes_.resize(2);
        for (std::uint32_t p = 0; p < 2; ++p) assigned_.parts[p].hypothesis = p;
        planes_[0].threshold = planes_[1].threshold = outline_threshold;
        SurfacePart& part = assigned_.parts[0];
        part.points = 300;
        part.sampled = 300;
        for (const SurfacePoint& p : points)
            if (sort_of_(p.position) == own) {
                part.some.push_back(p.position);
                part.box.extend(p.position);
            }
    }
    Vec3d strip(double y0, double y1, double z) { return {dice_.between(0, 4), dice_.between(y0, y1), z}; }
    // Numbers of points of each sort with the part's label afterwards.
    std::array<std::size_t, sorts> given(std::uint64_t least)
    {
        PointLabels labels(*tree_);
        for (const PlacedPoint& p : all_points(*tree_)) {
            const Sort sort = sort_of_(p.position);
            // Parts of no interest have labels, too.
            const std::uint32_t label = sort == own ? 1u : sort == others ? 2u : sort == inside ? 77u : 0u;
            labels.set(p.node, {p.number}, &label);
        }
        take_outline_points(ChosenPoints(tree_, {}), planes_, assigned_, labels, {outline_spacing, least, [] {}});
        std::array<std::size_t, sorts> found{};
        for (const PlacedPoint& p : all_points(*tree_))
            found[sort_of_(p.position)] += (labels.get(p.node)[p.number] & ~interior_label) == 1;
        return found;
    }

    Dice dice_{9};
    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::function<Sort(const Vec3d&)> sort_of_;
    std::vector<Hypothesis> planes_;
    AssignedPoints assigned_;
};

using Given = std::array<std::size_t, 6>;

TEST_F(OutlinePointsTest, ThoseWithinItAndNextToItThatBelongToNothingAreGiven)
{
    EXPECT_EQ(given(500), (Given{300, 100, 100, 0, 0, 0}));
    EXPECT_EQ(assigned_.parts[0].points, 500u);
    EXPECT_LT(assigned_.parts[0].box.min[1], -0.005);
    EXPECT_EQ(assigned_.parts[1].points, 0u);
}

TEST_F(OutlinePointsTest, PartsFarFromTheMinimumStayAsTheyAre)
{
    EXPECT_EQ(given(601), (Given{300, 0, 0, 0, 0, 0}));
    EXPECT_EQ(given(150), (Given{300, 0, 0, 0, 0, 0}));
    EXPECT_EQ(given(151)[inside], 100u);
}

TEST_F(OutlinePointsTest, PartsOfGroundStayAsTheyAre)
{
    assigned_.parts[0].edge = 100;
    assigned_.parts[0].continued = 6;
    EXPECT_EQ(given(500), (Given{300, 0, 0, 0, 0, 0}));
    assigned_.parts[0].continued = 5;
    EXPECT_EQ(given(500)[inside], 100u);
}

TEST_F(OutlinePointsTest, PartsInTreesAndCurvedOnesStayAsTheyAre)
{
    assigned_.parts[0].mixed = 31;
    EXPECT_EQ(given(500), (Given{300, 0, 0, 0, 0, 0}));
    assigned_.parts[0].mixed = 30;
    planes_[0].shape.kind = ShapeKind::cylinder;
    planes_[0].shape.axis = {1, 0, 0};
    planes_[0].shape.point = {0, 0.1, -5};
    planes_[0].shape.radius = 5;
    EXPECT_EQ(given(500)[inside], 0u);
    planes_[0].shape = {};
    EXPECT_EQ(given(500)[inside], 100u);
}

}  // namespace
