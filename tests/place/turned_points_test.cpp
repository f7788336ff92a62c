// Points next to the silhouettes of a pipe, which no station can have seen there.
#include "pcm/place/turned_points.h"

#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double pipe_radius = 0.03, scan_noise_of_pipe = 0.0015, pipe_threshold = 0.006;

pcm::Shape pipe_along_z()
{
    pcm::Shape pipe;
    pipe.kind = ShapeKind::cylinder;
    pipe.axis = {0, 0, 1};
    pipe.radius = pipe_radius;
    return pipe;
}

// Points of a pipe at angles of up to `arc` to both sides of the direction to their station.
void add_arc(double arc, double direction, std::uint32_t station, std::size_t count, Dice& dice,
             std::vector<PointOfStation>& points)
{
    for (std::size_t i = 0; i < count; ++i) {
        const double a = direction + std::asin(std::sin(arc) * dice.between(-1, 1));
        const double r = pipe_radius + scan_noise_of_pipe * dice.normal();
        points.push_back({{r * std::cos(a), r * std::sin(a), dice.between(0, 2)}, station});
    }
}

// Points behind both silhouettes of the pipe as the station sees it, farther from its axis.
void add_behind(double direction, std::uint32_t station, std::size_t count, Dice& dice,
                std::vector<PointOfStation>& points)
{
    for (std::size_t i = 0; i < count; ++i) {
        const double a = direction + (i % 2 ? 1 : -1) * dice.between(1.7, 2.5), r = pipe_radius + 0.003;
        points.push_back({{r * std::cos(a), r * std::sin(a), dice.between(0, 2)}, station});
    }
}

std::vector<PointOfStation> facing_of(const pcm::Shape& shape, const std::vector<PointOfStation>& points)
{
    return facing_points(StationDirections(shape, points), points);
}

ShapeFit fit_to(const std::vector<PointOfStation>& points)
{
    std::vector<Vec3d> places;
    for (const PointOfStation& p : points) places.push_back(p.place);
    RefineOptions refine;
    refine.threshold = pipe_threshold;
    return refine_shape(FitPoints::of(places), pipe_along_z(), refine);
}

TEST(TurnedPoints, PointsBehindASilhouetteDoNotFaceTheirStation)
{
    Dice dice(1);
    std::vector<PointOfStation> points;
    add_arc(1.3, 0, 7, 1000, dice, points);
    add_behind(0, 7, 20, dice, points);
    EXPECT_NEAR(static_cast<double>(facing_of(pipe_along_z(), points).size()), 1000, 10);
    for (PointOfStation& p : points) p.station = p.place[2] > 1 ? 7 : 8;
    const double half = pi / 2;
    add_arc(1.3, half, 9, 1000, dice, points);
    const std::vector<PointOfStation> facing = facing_of(pipe_along_z(), points);
    EXPECT_NEAR(static_cast<double>(facing.size()), 2000, 20) << "each station for itself";
}

TEST(TurnedPoints, PointsAllAroundAreKept)
{
    Dice dice(2);
    std::vector<PointOfStation> points;
    for (const double direction : {0.0, pi / 2, pi, -pi / 2}) add_arc(1.3, direction, 0, 300, dice, points);
    EXPECT_EQ(facing_of(pipe_along_z(), points).size(), points.size());
}

TEST(TurnedPoints, WithoutThemAPipeIsWhereItIsAndItsErrorsAreThoseOfItsArc)
{
    Dice dice(3);
    std::vector<PointOfStation> own, all;
    add_arc(1.2, 0, 7, 2000, dice, own);
    all = own;
    add_behind(0, 7, 60, dice, all);
    const ShapeFit without = fit_to(own);
    ShapeFit fit = fit_to(all);
    const auto off = [](const ShapeFit& one) { return std::hypot(one.shape.point[0], one.shape.point[1]); };
    const double before = off(fit), error = fit.errors.position;
    EXPECT_GT(before, 3 * error) << "a few points move it far";
    EXPECT_LT(error, 0.8 * without.errors.position) << "and seem to be an arc";
    leave_turned_points(facing_of(fit.shape, all), all, 1, fit);
    EXPECT_LT(off(fit), 0.5 * before);
    EXPECT_LT(off(fit), 3 * fit.errors.position);
    EXPECT_GT(fit.errors.position, 0.9 * without.errors.position);
    EXPECT_LT(std::fabs(fit.shape.radius - pipe_radius), 3 * fit.errors.radius);
    EXPECT_LT(fit.errors.position, before) << "no more than what they have moved it by";
}

// A radius of three centimetres cannot be made smaller by more.
TEST(TurnedPoints, WhereTheOthersMakeNoShapeItStaysAndIsDoubtful)
{
    Dice dice(4);
    std::vector<PointOfStation> own, all;
    add_arc(1.2, 0, 7, 500, dice, own);
    all = own;
    for (int i = 0; i < 500; ++i) {
        const double a = dice.between(0, 2 * pi);
        all.push_back({{0.07 * std::cos(a), 0.07 * std::sin(a), dice.between(0, 2)}, 7});
    }
    ShapeFit fit = fit_to(own);
    ASSERT_EQ(fit.verdict, FitVerdict::good);
    const double radius = fit.shape.radius;
    leave_turned_points(own, all, 1, fit);
    EXPECT_EQ(fit.shape.radius, radius);
    EXPECT_GT(fit.errors.radius, radius);
    EXPECT_EQ(fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(fit.issue, FitIssue::thin_arc);
    EXPECT_NE(fit.message.find("cannot have been seen there by their stations"), std::string::npos);
}

// A narrow strip of them does not show the radius.
TEST(TurnedPoints, WhereTheOthersLeaveTheSizeUncertainItIsDoubtful)
{
    Dice dice(5);
    std::vector<PointOfStation> wide, narrow;
    add_arc(1.2, 0, 7, 500, dice, wide);
    add_arc(0.25, 0, 7, 100, dice, narrow);
    const std::vector<PointOfStation> few = narrow;
    narrow.insert(narrow.end(), wide.begin(), wide.end());
    ShapeFit sure = fit_to(wide), uncertain = fit_to(narrow);
    leave_turned_points(wide, narrow, 1, sure);
    EXPECT_EQ(sure.verdict, FitVerdict::good) << sure.message;
    leave_turned_points(few, narrow, 1, uncertain);
    EXPECT_EQ(uncertain.verdict, FitVerdict::doubtful);
    EXPECT_EQ(uncertain.issue, FitIssue::thin_arc);
    uncertain = fit_to(narrow);
    uncertain.verdict = FitVerdict::refused;
    leave_turned_points(few, narrow, 1, uncertain);
    EXPECT_EQ(uncertain.verdict, FitVerdict::refused);
}

}  // namespace
