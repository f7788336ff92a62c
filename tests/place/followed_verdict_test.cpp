// The verdict on a fit that was followed through the cloud, by all the points that it got.

#include "pcm/place/followed_verdict.h"

#include "pcm/point_cloud.h"
#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

// A column of 200 mm, round or square, and the verdict about a cylinder along it.
class FollowedVerdictTest : public testing::Test {
protected:
    static constexpr double radius = 0.1148;  // mean distance of a square's border from its middle

    FittedPrimitive judged(bool is_square, double noise, double agreement = 1, bool converged = false)
    {
        Dice dice(7);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 6000; ++i) {
            const double along = dice.between(0, 2 * pi), away = noise * dice.normal(), u = dice.between(-0.1, 0.1);
            const double z = dice.between(0, 2);
            const std::array<Vec3d, 4> faces{
                {{0.1 + away, u, z}, {u, 0.1 + away, z}, {-0.1 - away, u, z}, {u, -0.1 - away, z}}};
            points.push_back({is_square
                                  ? faces[static_cast<std::size_t>(i) % 4]
                                  : Vec3d{(radius + away) * std::cos(along), (radius + away) * std::sin(along), z},
                              {}});
        }
        tree_ = build_surface_tree(folder_.path(), points);
        const auto cloud = PointCloud::open(tree_->folder());
        FittedPrimitive result{
            {}, set_where(tree_, [](const Vec3d&) { return true; }), {}, {}, {}, 0, 0, false, 1, {}, {}, {}};
        ShapeFit& fit = result.primitive.fit;
        fit.shape.kind = ShapeKind::cylinder;
        fit.shape.axis = {0, 0, 1};
        fit.shape.radius = radius;
        fit.verdict = FitVerdict::good;
        fit.noise = 0.013;
        fit.threshold = result.local.threshold = agreement > 1 ? 0.031 : 0.045;
        result.converged = converged;
        result.rounds = 8;
        // What is around it says nothing here.
        const PointSet around = set_where(tree_, [](const Vec3d& p) { return p[2] < 0; });
        const std::optional<SweptPart> part;
        const FitAtOptions options;
        const ProgressFunction progress;
        StationsAround stations(*cloud->tree(), places_.front());
        FollowedVerdict verdict(*cloud, places_, options, {0.01, 0.01, 0}, stations, progress);
        verdict.judge({around, fit.noise, agreement, part}, result);
        return result;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    const std::vector<Vec3d> places_{{0.1, 0, 1}};
};

TEST_F(FollowedVerdictTest, FourFacesAreNoCylinder)
{
    const FittedPrimitive post = judged(true, 0.0015);
    EXPECT_EQ(post.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(post.primitive.fit.issue, FitIssue::other_surface);
    EXPECT_NE(post.primitive.fit.message.find("to both sides"), std::string::npos) << post.primitive.fit.message;
}

TEST_F(FollowedVerdictTest, AsRoughACylinderIsOne)
{
    const FittedPrimitive column = judged(false, 0.012);
    EXPECT_EQ(column.primitive.fit.message.find("to both sides"), std::string::npos) << column.primitive.fit.message;
    EXPECT_EQ(column.primitive.fit.verdict, FitVerdict::good) << column.primitive.fit.message;
}

// An oval that is followed bit by bit never settles.
TEST_F(FollowedVerdictTest, WhatStillChangesIsDoubted)
{
    const FittedPrimitive changing = judged(false, 0.012, 3, false);
    EXPECT_EQ(changing.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(changing.primitive.fit.message.find("still changes after 8 rounds"), std::string::npos)
        << changing.primitive.fit.message;
    const FittedPrimitive settled = judged(false, 0.012, 3, true);
    EXPECT_EQ(settled.primitive.fit.verdict, FitVerdict::good) << settled.primitive.fit.message;
}

}  // namespace
