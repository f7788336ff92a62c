// Points of detected shapes that lie on others, too.
#include "pcm/detect/shared_points.h"

#include "pcm/detect/point_labels.h"
#include "tests/place/shape_cloud.h"

#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double shared_threshold = 0.004, shared_radius = 0.04;

// A cylinder along z, the first shape, and a plane that touches it at x = its radius, the second one; points have the
// label of one of them.
class SharedPointsTest : public testing::Test {
protected:
    // Points of the cylinder at these angles, from z to z + 1.
    void add_round(std::uint32_t label, double from, double to, double z, std::size_t count)
    {
        for (std::size_t i = 0; i < count; ++i) {
            const double a = dice_.between(from, to);
            add(label, {shared_radius * std::cos(a), shared_radius * std::sin(a), z + dice_.unit()});
        }
    }
    // Points of the plane at this distance from where it touches.
    void add_flat(std::uint32_t label, double from, double to, std::size_t count)
    {
        for (std::size_t i = 0; i < count; ++i)
            add(label, {shared_radius, (i % 2 ? 1 : -1) * dice_.between(from, to), dice_.unit()});
    }
    DetectReport judged()
    {
        std::vector<SurfacePoint> points;
        for (const auto& [label, p] : points_) points.push_back({p, {}});
        const auto tree = build_surface_tree(folder_.path(), points);
        const auto labels = std::make_shared<PointLabels>(*tree);
        DetectReport report;
        report.primitives = {cylinder(), plane()};
        for (const PlacedPoint& p : all_points(*tree)) {
            std::uint32_t label = 0;
            for (const auto& [own, place] : points_)
                if (length(place - p.position) < 1e-5) label = own;
            labels->set(p.node, {p.number}, &label);
            if (label > 0) ++report.primitives[label - 1].points;
        }
        report.labels = labels;
        DetectOptions options;
        options.threads = 1;
        doubt_shared_points(tree, options, report);
        return report;
    }

private:
    void add(std::uint32_t label, const Vec3d& p) { points_.push_back({label, p}); }
    static Primitive cylinder()
    {
        Primitive one = good(ShapeKind::cylinder);
        one.fit.shape.radius = shared_radius;
        one.bounds.to = 1;
        return one;
    }
    static Primitive plane()
    {
        Primitive one = good(ShapeKind::plane);
        one.fit.shape.point = {shared_radius, 0, 0};
        one.fit.shape.axis = {1, 0, 0};
        for (const double x : {shared_radius - 0.01, shared_radius + 0.01})
            for (const double y : {-0.5, 0.5})
                for (const double z : {-0.5, 2.5}) one.bounds.outline.push_back({x, y, z});
        return one;
    }
    static Primitive good(ShapeKind kind)
    {
        Primitive one;
        one.fit.verdict = FitVerdict::good;
        one.fit.shape.kind = kind;
        one.fit.shape.axis = {0, 0, 1};
        one.fit.threshold = shared_threshold;
        return one;
    }

    TemporaryFolder folder_;
    Dice dice_{5};
    std::vector<std::pair<std::uint32_t, Vec3d>> points_;
};

bool is_good(const Primitive& one) { return one.fit.verdict == FitVerdict::good; }

TEST_F(SharedPointsTest, APlaneOnAPipeIsDoubted)
{
    add_round(1, 0.4, 2 * pi - 0.4, 0, 600);
    add_round(2, -0.3, 0.3, 0, 300);
    const DetectReport report = judged();
    EXPECT_TRUE(is_good(report.primitives[0]));
    EXPECT_FALSE(is_good(report.primitives[1]));
    EXPECT_EQ(report.primitives[1].fit.issue, FitIssue::other_surface);
}

TEST_F(SharedPointsTest, APlaneWhereAPipeWouldContinueIsDoubted)
{
    add_round(1, 0, 2 * pi, 0, 500);
    add_round(2, -0.3, 0.3, 1, 300);
    const DetectReport report = judged();
    EXPECT_TRUE(is_good(report.primitives[0]));
    EXPECT_FALSE(is_good(report.primitives[1]));
}

TEST_F(SharedPointsTest, APlaneThatAPipeTouchesIsGood)
{
    add_round(1, 0, 2 * pi, 0, 600);
    add_flat(2, 0, 0.1, 600);
    const DetectReport report = judged();
    EXPECT_TRUE(is_good(report.primitives[0]));
    EXPECT_TRUE(is_good(report.primitives[1]));
}

TEST_F(SharedPointsTest, ANarrowPlaneAlongAPipeThatFitsItsPointsBetterIsGood)
{
    add_round(1, 0, 2 * pi, 0, 600);
    add_flat(2, 0, 0.015, 300);
    EXPECT_TRUE(is_good(judged().primitives[1]));
}

TEST_F(SharedPointsTest, ACylinderOfAPlanesPointsIsDoubtedAndThePlaneIsNot)
{
    add_round(1, -0.3, 0.3, 0, 200);
    add_flat(2, 0, 0.015, 500);
    const DetectReport report = judged();
    EXPECT_FALSE(is_good(report.primitives[0]));
    EXPECT_EQ(report.primitives[0].fit.issue, FitIssue::other_surface);
    EXPECT_TRUE(is_good(report.primitives[1]));
}

}  // namespace
