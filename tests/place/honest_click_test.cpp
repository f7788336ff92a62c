// Clicks on what is not quite a shape, or hardly another one: no wrong shape is called good.
#include "pcm/place/cover_points.h"
#include "pcm/place/fit_at.h"

#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.0015;
constexpr Vec3d map{456780, 5432100, 120};

class HonestClick : public testing::Test {
protected:
    FittedPrimitive at(const std::vector<SurfacePoint>& points, const Vec3d& place)
    {
        build_surface_tree(folder_.path(), points);
        cloud_ = PointCloud::open(folder_ / "surface.pct");
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        return fit_at(*cloud_, {place}, {}, options);
    }
    Dice dice_{12};
    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
};

// 600 x 540 mm. Before, "cylinder: good" with a radius that depended on the place.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(AnOvalPipeIsOutOfRound))
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 12000; ++i) {
        const double a = dice_.between(0, 2 * pi);
        const Vec3d n = normalised({std::cos(a) / 0.3, std::sin(a) / 0.27, 0});
        points.push_back(
            {map + Vec3d{0.3 * std::cos(a), 0.27 * std::sin(a), dice_.between(0, 1.8)} + sigma * dice_.normal() * n,
             n});
    }
    for (const int i : {0, 100, 2000}) {
        const FittedPrimitive fitted = at(points, points[static_cast<std::size_t>(i)].position);
        EXPECT_NE(fitted.primitive.fit.verdict, FitVerdict::good)
            << text_of(fitted.primitive.fit.shape) << ", noise " << fitted.primitive.fit.noise;
    }
}

// 20 degrees of a cylinder of 2 m. Before, a plane.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(AnArcIsNoPlane))
{
    pcm::Shape arc;
    arc.kind = ShapeKind::cylinder;
    arc.point = map;
    arc.axis = normalised({0.1, 0.2, 1});
    arc.radius = 2;
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 15000; ++i) points.push_back(point_on(arc, 1.4, pi / 9, sigma, dice_));
    const FittedPrimitive fitted = at(points, points[7].position);
    const ShapeFit& fit = fitted.primitive.fit;
    EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
    ASSERT_EQ(fit.shape.kind, ShapeKind::cylinder);
    EXPECT_LT(std::fabs(fit.shape.radius - 2), 4 * fit.errors.radius);
}

// Half an angle of 10 degrees. Before, a cylinder around the place.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(AReducerIsNoCylinder))
{
    pcm::Shape cone;
    cone.kind = ShapeKind::cone;
    cone.point = map;
    cone.axis = {0, 0, 1};
    cone.second = 10 * pi / 180;
    std::vector<SurfacePoint> points;
    while (points.size() < 6000) {
        const SurfacePoint p = point_on(cone, 1.2, pi, sigma, dice_);
        if (p.position[2] - map[2] > 0.6) points.push_back(p);
    }
    const ShapeFit fit = at(points, points[11].position).primitive.fit;
    EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
    ASSERT_EQ(fit.shape.kind, ShapeKind::cone);
    EXPECT_LT(std::fabs(fit.shape.second - cone.second), 4 * fit.errors.second);
}

// Half of two pipes of 40 and 34 mm with a reducer between, within 4 mm of one turned cylinder. Before, this cylinder
// was the answer, with the verdict good and its axis 4 mrad off.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(APipeEndsAtItsReducer))
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 18000; ++i) {
        const double way = dice_.between(-1, 1.3), angle = dice_.between(-1.3, 1.3);
        const Vec3d n{std::cos(angle), std::sin(angle), 0};
        const double radius = 0.04 - 0.006 * std::clamp((way + 0.02) / 0.05, 0.0, 1.0);
        points.push_back({map + Vec3d{0, 0, way} + (radius + sigma * dice_.normal()) * n, n});
    }
    for (const double way : {-0.3, 0.5}) {
        const auto near_way = [&](const SurfacePoint& p) { return std::fabs(p.position[2] - map[2] - way) < 0.01; };
        const FittedPrimitive fitted = at(points, std::find_if(points.begin(), points.end(), near_way)->position);
        const ShapeFit& fit = fitted.primitive.fit;
        ASSERT_EQ(fit.shape.kind, ShapeKind::cylinder);
        EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
        EXPECT_LT(std::fabs(fit.shape.radius - (way < 0 ? 0.04 : 0.034)), 4 * fit.errors.radius) << way;
        EXPECT_LT(length(cross(fit.shape.axis, {0, 0, 1})), 4 * fit.errors.angle) << way;
    }
}

// Near its end the neighbourhood is a piece of a cylinder, which cannot be followed; a wider one is an elbow.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(TheEndOfAnElbowIsOneOfAnElbow))
{
    const double wide = 0.2, narrow = 0.1;
    std::vector<SurfacePoint> points;
    const auto put = [&](const Vec3d& middle, const Vec3d& out, const Vec3d& side) {
        const double a = dice_.between(0, 2 * pi);
        const Vec3d n = std::cos(a) * out + std::sin(a) * side;
        points.push_back({map + middle + (narrow + sigma * dice_.normal()) * n, n});
    };
    std::vector<Vec3d> ends;  // points of the elbow's first 20 degrees
    while (points.size() < 20000) {
        const double way = dice_.between(-0.1, wide * pi / 2 + 0.1), angle = std::clamp(way / wide, 0.0, pi / 2);
        const Vec3d out{std::cos(angle), std::sin(angle), 0}, along{-std::sin(angle), std::cos(angle), 0};
        put(wide * out + (way - wide * angle) * along, out, {0, 0, 1});
        if (ends.size() < 8 && way > 0 && way < wide / 3) ends.push_back(points.back().position);
    }
    int tori = 0;
    for (const Vec3d& end : ends) {
        const ShapeFit fit = at(points, end).primitive.fit;
        if (fit.verdict != FitVerdict::good || fit.shape.kind != ShapeKind::torus) continue;
        ++tori;
        EXPECT_LT(std::fabs(fit.shape.radius - wide), 4 * fit.errors.radius);
        EXPECT_LT(std::fabs(fit.shape.second - narrow), 4 * fit.errors.second);
    }
    EXPECT_GE(tori, 7) << "without the wider neighbourhood six";
}

// Next to its tangent an elbow is within the noise of its pipe. Before, a click there was answered as the pipe. The
// points farther along the bend are those of the elbow.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(ByAnElbowsTangentTheElbowIsAnswered))
{
    const double wide = 0.15, narrow = 0.05;
    std::vector<SurfacePoint> points;
    std::vector<Vec3d> bent, straight;
    while (points.size() < 20000) {
        const double way = dice_.between(-0.6, wide * pi / 2 + 0.4), angle = std::clamp(way / wide, 0.0, pi / 2);
        const Vec3d out{std::cos(angle), std::sin(angle), 0}, along{-std::sin(angle), std::cos(angle), 0};
        const double a = dice_.between(0, 2 * pi);
        const Vec3d n = std::cos(a) * out + std::sin(a) * Vec3d{0, 0, 1};
        points.push_back({map + wide * out + (way - wide * angle) * along + (narrow + sigma * dice_.normal()) * n, n});
        if (way > 0 && way < 0.02 && bent.size() < 8) bent.push_back(points.back().position);
        if (way > -0.3 && way < -0.1 && straight.size() < 4) straight.push_back(points.back().position);
    }
    int tori = 0;
    for (const Vec3d& place : bent) {
        const ShapeFit fit = at(points, place).primitive.fit;
        if (fit.verdict != FitVerdict::good) continue;
        ++tori;
        ASSERT_EQ(fit.shape.kind, ShapeKind::torus);
        EXPECT_LT(std::fabs(fit.shape.radius - wide), 4 * fit.errors.radius);
        EXPECT_LT(std::fabs(fit.shape.second - narrow), 4 * fit.errors.second);
    }
    EXPECT_EQ(tori, 8) << "without the points farther along the bend seven";
    for (const Vec3d& place : straight) {
        const ShapeFit fit = at(points, place).primitive.fit;
        EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
        EXPECT_EQ(fit.shape.kind, ShapeKind::cylinder);
    }
}

// An elbow of few points, seen from one side, between long pipes that have most of the points around. Before, a
// doubtful cylinder.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(AnElbowBetweenPipesIsNoCylinder))
{
    const double wide = 0.1356, narrow = 0.0452;
    std::vector<SurfacePoint> points;
    std::vector<Vec3d> bent;
    while (points.size() < 9000) {
        const double way = dice_.between(-1.2, wide * pi / 2 + 1.2), angle = std::clamp(way / wide, 0.0, pi / 2);
        const Vec3d out{std::cos(angle), std::sin(angle), 0}, along{-std::sin(angle), std::cos(angle), 0};
        const double a = dice_.between(0.1, 2.6);
        const Vec3d n = std::cos(a) * out + std::sin(a) * Vec3d{0, 0, 1};
        points.push_back({map + wide * out + (way - wide * angle) * along + (narrow + sigma * dice_.normal()) * n, n});
        if (way > 0.02 && way < 0.19 && bent.size() < 12) bent.push_back(points.back().position);
    }
    int tori = 0;
    for (const Vec3d& place : bent) {
        const ShapeFit fit = at(points, place).primitive.fit;
        if (fit.verdict != FitVerdict::good) continue;
        ASSERT_EQ(fit.shape.kind, ShapeKind::torus);
        ++tori;
        EXPECT_LT(std::fabs(fit.shape.radius - wide), 4 * fit.errors.radius);
        EXPECT_LT(std::fabs(fit.shape.second - narrow), 4 * fit.errors.second);
    }
    EXPECT_GE(tori, 11) << "without the torus alone ten";
}

// A square post of 200 mm, points 17 mm apart, of two stations that are not known and 2 mm apart. Before, "cylinder:
// good, 0.1145" with a noise of 12.5 mm at this place.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(ASquarePostIsNoCylinder))
{
    constexpr double half = 0.1, apart = 0.017;
    Dice dice(15);
    std::vector<SurfacePoint> points;
    const std::array<double, 2> shifts{sigma * dice.normal(), sigma * dice.normal()};
    for (int i = 0; i < static_cast<int>(2 * half * 1.2 / (apart * apart)); ++i)
        for (const double side : {1, -1})
            for (const bool is_x : {false, true}) {
                const double away = side * half + shifts[static_cast<std::size_t>(i) % 2] + 0.0013 * dice.normal(),
                             along = dice.between(-half, half);
                points.push_back({map + Vec3d{is_x ? away : along, is_x ? along : away, dice.between(-0.6, 0.6)}, {}});
            }
    for (const double in : {0.0127, 0.005, 0.009, 0.016}) {
        const ShapeFit fit = at(points, map + Vec3d{half - in, half + 0.002, 0.1}).primitive.fit;
        EXPECT_FALSE(fit.verdict == FitVerdict::good && fit.shape.kind != ShapeKind::plane)
            << in << ": " << text_of(fit.shape);
    }
}

// The noise next to the place is less than half of that farther on, and the first threshold cuts that. Before, a
// doubtful patch around the place.
TEST_F(HonestClick, PCM_NOT_UNDER_SANITIZERS(AWallIsFollowedWhereItsNoiseRises))
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 24000; ++i) {
        const Vec3d at{dice_.between(-2, 2), dice_.between(-2, 2), 0};
        const double noise = length(at) < 0.95 ? sigma : 2.2 * sigma;
        points.push_back({map + at + Vec3d{0, 0, noise * dice_.normal()}, {0, 0, 1}});
    }
    const FittedPrimitive fitted = at(points, map);
    EXPECT_EQ(fitted.primitive.fit.verdict, FitVerdict::good) << fitted.primitive.fit.message;
    EXPECT_EQ(fitted.primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_GT(fitted.points.size(), 23000u);
    EXPECT_GT(fitted.reached.threshold, 4 * sigma);
}

// A ball over a floor that has most of the points around it. Before, the floor was good, and was not followed.
TEST_F(HonestClick, AShapeWithoutPointsAtThePlaceIsDoubted)
{
    std::vector<SurfacePoint> points;
    pcm::Shape ball;
    ball.kind = ShapeKind::sphere;
    ball.point = map + Vec3d{0, 0, 0.3};
    ball.radius = 0.05;
    for (int i = 0; i < 1200; ++i) points.push_back(point_on(ball, 0, 0, sigma, dice_));
    for (int i = 0; i < 20000; ++i)
        points.push_back({map + Vec3d{dice_.between(-1, 1), dice_.between(-1, 1), sigma * dice_.normal()}, {0, 0, 1}});
    build_surface_tree(folder_.path(), points);
    cloud_ = PointCloud::open(folder_ / "surface.pct");
    FitAtOptions options;
    options.fit.threshold = 0.006;
    options.radius = 0.8;
    const FittedPrimitive floor = fit_at(*cloud_, {points[3].position}, {}, options);
    ASSERT_EQ(floor.primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_EQ(floor.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(floor.left_surface.find("none of the nearest points"), std::string::npos) << floor.left_surface;
}

// Points of coarse levels represent their cells, and lie on one side of a noisy surface.
TEST_F(HonestClick, RandomPointsLieAboutTheirSurface)
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 24000; ++i)
        points.push_back({map + Vec3d{dice_.between(-2, 2), dice_.between(-2, 2), sigma * dice_.normal()}, {0, 0, 1}});
    build_surface_tree(folder_.path(), points);
    cloud_ = PointCloud::open(folder_ / "surface.pct");
    PointSet all(cloud_->tree());
    for (NodeId id = 0; id < cloud_->tree()->nodes().size(); ++id) {
        std::vector<std::uint32_t> numbers(cloud_->tree()->node(id).points);
        std::iota(numbers.begin(), numbers.end(), 0u);
        all.set(id, numbers);
    }
    const std::vector<Vec3d> some = random_points(all, 4000, 1);
    EXPECT_NEAR(static_cast<double>(some.size()), 4000, 4 * std::sqrt(4000));
    double mean = 0;
    for (const Vec3d& p : some) mean += (p[2] - map[2]) / static_cast<double>(some.size());
    EXPECT_LT(std::fabs(mean), 4 * sigma / std::sqrt(static_cast<double>(some.size())));
    EXPECT_EQ(random_points(all, 4000, 3), some);
    EXPECT_EQ(random_points(all, 24000).size(), 24000u);
}

}  // namespace
