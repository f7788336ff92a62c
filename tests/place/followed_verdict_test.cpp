// The verdict on a fit that was followed through the cloud, by all the points that it got.

#include "pcm/place/followed_verdict.h"

#include "pcm/point_cloud.h"
#include "tests/place/station_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

// Points of one plane or of two, and of a wall of large radius, all within the threshold of a plane between them.
enum class Wall { two_faces, round };

// A column of 200 mm, round or square, and the verdict about a cylinder along it.
class FollowedVerdictTest : public testing::Test {
protected:
    static constexpr double radius = 0.1148;  // mean distance of a square's border from its middle

    FittedPrimitive judged(bool is_square, double noise, double agreement = 1, bool converged = false)
    {
        Dice dice(7);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < beside_; ++i) {
            const double x = crosses_ ? dice.between(0.04, 0.28) : 0.23 + 0.01 * dice.normal();
            points.push_back({{x, dice.between(-0.01, 0.01), -dice.between(0.1, 2)}, {}});
        }
        for (int i = 0; i < quiet_; ++i)
            points.push_back({{1 + 0.001 * dice.normal(), dice.between(-1, 1), -dice.between(0.1, 2)}, {}});
        for (int i = 0; i < count_; ++i) {
            const double along = dice.between(0, 2 * pi), away = noise * dice.normal(), u = dice.between(-0.1, 0.1);
            const double z = dice.between(0, 2);
            const std::array<Vec3d, 4> faces{
                {{0.1 + away, u, z}, {u, 0.1 + away, z}, {-0.1 - away, u, z}, {u, -0.1 - away, z}}};
            points.push_back({is_square
                                  ? faces[static_cast<std::size_t>(i) % 4]
                                  : Vec3d{(radius + away) * std::cos(along), (radius + away) * std::sin(along), z},
                              {}});
        }
        ShapeFit fit;
        fit.shape.kind = ShapeKind::cylinder;
        fit.shape.axis = {0, 0, 1};
        fit.shape.radius = radius;
        fit.noise = 0.013;
        fit.threshold = agreement > 1 ? 0.031 : 0.045;
        return judged(points, fit, 0.01, agreement, converged);
    }

    // A piece of 8 m of a wall of 1000 m radius, or the two faces of a plate, each with half of the points. `before`:
    // the issue of the fit at the place.
    FittedPrimitive judged(Wall wall, FitIssue before)
    {
        constexpr double noise = 0.0015;
        Dice dice(8);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 6000; ++i) {
            const double x = dice.between(-4, 4), z = dice.between(0, 2);
            const double y = wall == Wall::round ? x * x / 2000 - 0.0027 : i % 2 ? 0.003 : -0.003;
            points.push_back({{x, y + noise * dice.normal(), z}, {}});
        }
        ShapeFit fit;
        fit.shape.kind = ShapeKind::plane;
        fit.shape.axis = {0, 1, 0};
        fit.noise = 0.003;
        fit.threshold = 0.009;
        fit.verdict = FitVerdict::good;
        if (before != FitIssue::none) doubt(fit, before, "as it was");
        return judged(points, fit, noise, 1, true);
    }

    // The verdict, where `fit` is good, or is doubted already.
    FittedPrimitive judged(const std::vector<SurfacePoint>& points, const ShapeFit& fit, double close_noise,
                           double agreement, bool converged)
    {
        tree_ = tree(points);
        const auto cloud = PointCloud::open(tree_->folder());
        FittedPrimitive result{
            {}, set_where(tree_, [](const Vec3d& p) { return p[2] >= 0; }), {}, {}, {}, 0, 0, false, 1, {}, {}, {}, {}};
        result.primitive.fit = fit;
        result.primitive.fit.inliers = result.points.size();
        if (fit.issue == FitIssue::none) result.primitive.fit.verdict = FitVerdict::good;
        result.local.threshold = fit.threshold;
        result.converged = converged;
        if (is_one_side_) result.reached.limit.clips.push_back({Region::sphere({0, 0, 1}, 9), false});
        result.rounds = 8;
        // All points, or nothing.
        const PointSet around = set_where(tree_, [&](const Vec3d& p) { return beside_ > 0 || p[2] < 0; });
        FitAtOptions options;
        options.kinds = kinds_;
        const ProgressFunction progress;
        StationsAround stations(*cloud->tree(), places_.front());
        FollowedVerdict verdict(*cloud, places_, options, {less_noise_ * close_noise, less_noise_ * close_noise, 0},
                                stations, progress);
        verdict.judge({around, fit.noise, agreement, part_, inner_share_}, result);
        return result;
    }

    // Points of two stations that see all of it, or of none that are known.
    std::shared_ptr<const Tree> tree(const std::vector<SurfacePoint>& points) const
    {
        if (!has_stations_) return build_surface_tree(folder_.path(), points);
        std::vector<StationPoint> seen;
        for (const SurfacePoint& p : points) seen.push_back({p.position, static_cast<int>(seen.size() / 4 % 2)});
        return build_station_tree(folder_.path(), seen, Says::source_id, 2000);
    }

    TemporaryFolder folder_;
    bool has_stations_ = false;
    bool is_one_side_ = false;  // whether the shape was followed on one side of an edge
    double less_noise_ = 1;     // factor on the noise of the closest points
    std::shared_ptr<const Tree> tree_;
    double inner_share_ = 1;
    std::optional<SweptPart> part_;
    int count_ = 6000;      // number of points of the column
    int beside_ = 0;        // number of points next to the column
    int quiet_ = 0;         // number of points of a wall 1 m away, of little noise
    bool crosses_ = false;  // whether they are those of a wall that crosses it, or of one along it
    const std::vector<Vec3d> places_{{0.1, 0, 1}};
    std::vector<ShapeKind> kinds_;
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

// A plane through a wall of large radius: points leave it to both sides, but keep to one smooth surface.
TEST_F(FollowedVerdictTest, AWallOfLargeRadiusIsBulgedByItsRms)
{
    for (const FitIssue before : {FitIssue::none, FitIssue::other_surface}) {
        const FittedPrimitive wall = judged(Wall::round, before);
        EXPECT_EQ(wall.primitive.fit.verdict, FitVerdict::doubtful);
        EXPECT_EQ(wall.primitive.fit.issue, FitIssue::uneven) << wall.primitive.fit.message;
        ASSERT_TRUE(wall.departure);
        EXPECT_NEAR(wall.departure->size, 0.0024, 0.0002);  // rms of x^2 / 2000 about its mean
        EXPECT_NEAR(wall.departure->rest, 0.0015, 0.0002);
        EXPECT_NE(wall.primitive.fit.message.find("together by 0.002"), std::string::npos)
            << wall.primitive.fit.message;
    }
    const FittedPrimitive refused = judged(Wall::round, FitIssue::no_consensus);
    EXPECT_EQ(refused.primitive.fit.message, "as it was");
    EXPECT_FALSE(refused.departure);
}

TEST_F(FollowedVerdictTest, TwoFacesAreNotBulged)
{
    const FittedPrimitive plate = judged(Wall::two_faces, FitIssue::none);
    EXPECT_EQ(plate.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(plate.primitive.fit.issue, FitIssue::other_surface) << plate.primitive.fit.message;
    EXPECT_FALSE(plate.departure);
}

// Strips of pipes as planes: the points of each lie next to those of its sides.
TEST_F(FollowedVerdictTest, WhatLiesNextToOthersNearlyEverywhereIsDoubted)
{
    inner_share_ = 0.03;
    count_ = 400;
    beside_ = 200;
    EXPECT_EQ(judged(false, 0.012).primitive.fit.verdict, FitVerdict::good) << "the other face of a plate";
    crosses_ = true;
    const FittedPrimitive strip = judged(false, 0.012);
    EXPECT_EQ(strip.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(strip.primitive.fit.issue, FitIssue::other_surface);
    EXPECT_NE(strip.primitive.fit.message.find("strip"), std::string::npos) << strip.primitive.fit.message;
    inner_share_ = 0.3;
    EXPECT_EQ(judged(false, 0.012).primitive.fit.verdict, FitVerdict::good);
    inner_share_ = 0.12;
    EXPECT_EQ(judged(false, 0.012).primitive.fit.verdict, FitVerdict::doubtful);
    count_ = 900;
    EXPECT_EQ(judged(false, 0.012).primitive.fit.verdict, FitVerdict::doubtful);
    count_ = 1100;
    EXPECT_EQ(judged(false, 0.012).primitive.fit.verdict, FitVerdict::good) << "many points have a wide face";
    count_ = 400;
    crosses_ = false;
    inner_share_ = 0;
    EXPECT_EQ(judged(false, 0.012).primitive.fit.verdict, FitVerdict::doubtful) << "all of them";
}

// A face 12 mm wide with points of the faces next to it. Where these are, and where only one side of it was looked at.
TEST_F(FollowedVerdictTest, AStripThatItsNeighboursMayHaveTurnedIsDoubted)
{
    constexpr double noise = 0.0015;
    const auto of_width = [&](double width) {
        Dice dice(9);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 1500; ++i)
            points.push_back({{dice.between(-width / 2, width / 2), noise * dice.normal(), dice.between(0, 2)}, {}});
        ShapeFit fit;
        fit.shape.kind = ShapeKind::plane;
        fit.shape.axis = {0, 1, 0};
        fit.noise = noise;
        fit.threshold = 3 * noise;
        return judged(points, fit, noise, 1, true).primitive.fit;
    };
    EXPECT_EQ(of_width(0.012).verdict, FitVerdict::good) << "a strip that stands alone";
    inner_share_ = 0.4;
    const ShapeFit strip = of_width(0.012);
    EXPECT_EQ(strip.verdict, FitVerdict::doubtful);
    EXPECT_EQ(strip.issue, FitIssue::thin_arc);
    EXPECT_NE(strip.message.find("degrees"), std::string::npos) << strip.message;
    EXPECT_EQ(of_width(0.12).verdict, FitVerdict::good);
    inner_share_ = 1;
    is_one_side_ = true;
    EXPECT_EQ(of_width(0.012).verdict, FitVerdict::doubtful);
    EXPECT_EQ(of_width(0.12).verdict, FitVerdict::good);
}

// Crowns of a rack as a plane. Stations that are known, and not apart, do not explain what neighbours share.
TEST_F(FollowedVerdictTest, WhatNeighboursShareIsDoubtedWhereStationsDoNotExplainIt)
{
    less_noise_ = 0.6;
    for (const bool is_known : {false, true}) {
        has_stations_ = is_known;
        const FittedPrimitive shared = judged(false, 0.012, 3, true);
        EXPECT_EQ(shared.primitive.fit.verdict, is_known ? FitVerdict::doubtful : FitVerdict::good)
            << shared.primitive.fit.message;
        EXPECT_EQ(judged(false, 0.012, 1, true).primitive.fit.verdict, FitVerdict::good);
    }
    less_noise_ = 1;
    EXPECT_EQ(judged(false, 0.012, 3, true).primitive.fit.verdict, FitVerdict::good);
    // The closest points are those of several surfaces, and a wall next to these shows the noise.
    quiet_ = 12000;
    const FittedPrimitive beside_wall = judged(false, 0.012, 3, true);
    EXPECT_EQ(beside_wall.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(beside_wall.primitive.fit.message.find("together"), std::string::npos)
        << beside_wall.primitive.fit.message;
    // Neighbours do not share it, but a curved surface is as smooth as those around.
    const FittedPrimitive rough = judged(false, 0.012, 1, true);
    EXPECT_EQ(rough.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(rough.primitive.fit.message.find("those of smooth surfaces around"), std::string::npos)
        << rough.primitive.fit.message;
    has_stations_ = false;
    EXPECT_EQ(judged(false, 0.012, 1, true).primitive.fit.verdict, FitVerdict::good);
}

// A bent pipe as a cylinder, where the closest points say less of the noise than others: what is left is not that of a
// smooth surface, but the bend is most of what they leave the cylinder by, and stations do not explain it.
TEST_F(FollowedVerdictTest, WhatPointsLeaveTogetherBeyondStationsIsDoubted)
{
    constexpr double noise = 0.0015;
    const auto of_bend = [&](double bend) {
        Dice dice(12);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 6000; ++i) {
            const double along = dice.between(0, 2 * pi), r = 0.1 + noise * dice.normal(), z = dice.between(0, 2);
            const double off = bend * ((z - 1) * (z - 1) - 1.0 / 3);
            points.push_back({{r * std::cos(along) + off, r * std::sin(along), z}, {}});
        }
        ShapeFit fit;
        fit.shape.kind = ShapeKind::cylinder;
        fit.shape.axis = {0, 0, 1};
        fit.shape.radius = 0.1;
        fit.noise = 0.0022;
        fit.threshold = 0.0075;
        return judged(points, fit, 0.0008, 1, true).primitive.fit;
    };
    has_stations_ = true;
    EXPECT_EQ(of_bend(0.002).verdict, FitVerdict::good) << of_bend(0.002).message;
    const ShapeFit bent = of_bend(0.0085);
    EXPECT_EQ(bent.verdict, FitVerdict::doubtful);
    EXPECT_EQ(bent.issue, FitIssue::other_surface);
    EXPECT_NE(bent.message.find("which shifts of the stations do not explain"), std::string::npos) << bent.message;
}

// Crowns of a rack of thin pipes, and an uneven wall, as planes; next to them is a smooth wall of 1 mm noise.
TEST_F(FollowedVerdictTest, APlaneThatEachStationLeavesIsDoubted)
{
    const auto leaving = [&](double alone, double together) {
        Dice dice(15);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 6000; ++i) {
            const double x = dice.between(-0.5, 0.5), z = dice.between(0, 1);
            const double away = alone * dice.normal() + 2 * together * std::sin(12 * x) * std::sin(12 * z);
            points.push_back({{x, away, z}, {}});
        }
        for (int i = 0; i < 60000; ++i)
            points.push_back({{dice.between(-2, 2), 0.001 * dice.normal(), dice.between(-4, -0.1)}, {}});
        ShapeFit fit;
        fit.shape.kind = ShapeKind::plane;
        fit.shape.axis = {0, 1, 0};
        fit.noise = std::hypot(alone, together);
        fit.threshold = 3 * fit.noise;
        return judged(points, fit, fit.noise, 1, true).primitive.fit;
    };
    EXPECT_EQ(leaving(0.0045, 0).verdict, FitVerdict::good) << "no station is known";
    has_stations_ = true;
    const ShapeFit crowns = leaving(0.0045, 0);
    EXPECT_EQ(crowns.verdict, FitVerdict::doubtful);
    EXPECT_EQ(crowns.issue, FitIssue::other_surface);
    EXPECT_NE(crowns.message.find("the points of each station leave it by 0.0044"), std::string::npos)
        << crowns.message;
    EXPECT_EQ(leaving(0.0022, 0).verdict, FitVerdict::good) << leaving(0.0022, 0).message;
    const ShapeFit uneven = leaving(0.001, 0.0045);
    EXPECT_EQ(uneven.message.find("the points of each station"), std::string::npos) << uneven.message;
}

// The rim of a flange, 15 mm wide, is a band of a cylinder or of a sphere; a pipe is not a sphere.
TEST_F(FollowedVerdictTest, BandsThatAreOfTwoKindsAreDoubted)
{
    const auto of_width = [&](double width, int count) {
        Dice dice(13);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < count; ++i) {
            const double along = dice.between(0, 2 * pi), r = 0.1 + 0.0015 * dice.normal();
            points.push_back({{r * std::cos(along), r * std::sin(along), 1 + dice.between(-width, width) / 2}, {}});
        }
        ShapeFit fit;
        fit.shape.kind = ShapeKind::cylinder;
        fit.shape.axis = {0, 0, 1};
        fit.shape.radius = 0.1;
        fit.noise = 0.0015;
        fit.threshold = 0.005;
        return judged(points, fit, 0.0015, 1, true).primitive.fit;
    };
    EXPECT_EQ(of_width(0.015, 300).verdict, FitVerdict::good) << "cylinders alone are wanted";
    kinds_ = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere};
    const ShapeFit rim = of_width(0.015, 300);
    EXPECT_EQ(rim.verdict, FitVerdict::doubtful);
    EXPECT_NE(rim.message.find("a sphere fits these points as well"), std::string::npos) << rim.message;
    EXPECT_EQ(of_width(0.3, 300).verdict, FitVerdict::good) << of_width(0.3, 300).message;
}

// Two rims of a pair of flanges, as a sphere that has points next to them, too.
TEST_F(FollowedVerdictTest, SpheresAlongBandsOfCylindersAreDoubted)
{
    Dice dice(14);
    std::vector<SurfacePoint> points;
    const auto put = [&](double r, double z) {
        const double along = dice.between(0, 2);
        points.push_back({{r * std::cos(along), r * std::sin(along), 1 + z}, {}});
    };
    for (int i = 0; i < 800; ++i) put(0.4 + 0.0015 * dice.normal(), (i % 2 ? 1 : -1) * dice.between(0.005, 0.03));
    kinds_ = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere};
    ShapeFit fit;
    fit.shape = {ShapeKind::sphere, {0, 0, 1}, {0, 0, 1}, 0.4005, 0};
    fit.noise = 0.0015;
    fit.threshold = 0.005;
    const auto verdict = [&] { return judged(points, fit, 0.0015, 1, true).primitive.fit.verdict; };
    EXPECT_EQ(verdict(), FitVerdict::doubtful);
    // Points of the sphere far from the band, which the cylinder does not have.
    for (int i = 0; i < 60; ++i) {
        const double z = dice.between(0.1, 0.12);
        put(std::sqrt(0.4005 * 0.4005 - z * z), z);
    }
    EXPECT_EQ(verdict(), FitVerdict::doubtful) << "by the points on both";
    points.clear();
    for (int i = 0; i < 800; ++i) {
        const double z = dice.between(-0.15, 0.15);
        put(std::sqrt(0.4005 * 0.4005 - z * z) + 0.0015 * dice.normal(), z);
    }
    EXPECT_EQ(verdict(), FitVerdict::good) << "a part of a ball";
}

// The straight pipe behind an elbow is followed with it, and is not a part of its torus.
TEST_F(FollowedVerdictTest, APlaceBehindTheEndOfABendIsDoubted)
{
    part_.emplace();
    part_->shape.kind = ShapeKind::torus;
    part_->shape.axis = {0, 0, 1};
    part_->shape.radius = 1;
    part_->start = {-1, 0, 0};  // the place is at half a turn from it
    part_->to = 2 * pi;
    EXPECT_EQ(judged(false, 0.012).primitive.fit.verdict, FitVerdict::good);
    part_->from = 3.3;
    const FittedPrimitive behind = judged(false, 0.012);
    EXPECT_EQ(behind.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(behind.primitive.fit.message.find("end of the bend"), std::string::npos) << behind.primitive.fit.message;
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
