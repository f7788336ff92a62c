// Shapes of different boxes that are brought together.

#include "pcm/detect/hypotheses.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.002, threshold = 0.008;

Hypothesis hypothesis(const pcm::Shape& shape, const std::vector<Vec3d>& points, double area)
{
    Hypothesis one;
    one.shape = shape;
    one.some = points;
    one.area = area;
    one.threshold = threshold;
    double squares = 0;
    for (const Vec3d& p : points) {
        one.box.extend(p);
        squares += signed_distance(shape, p) * signed_distance(shape, p);
    }
    one.rms = std::sqrt(squares / static_cast<double>(points.size()));
    return one;
}

// A square of a plane: its lower corner, height and slope along x.
Hypothesis square(double x, double y, double height, double slope, std::uint64_t seed)
{
    Dice dice(seed);
    pcm::Shape plane;
    plane.point = {x, y, height};
    plane.axis = normalised(Vec3d{-slope, 0, 1});
    std::vector<Vec3d> points;
    for (int i = 0; i < 200; ++i) {
        const double dx = dice.between(0, 5), dy = dice.between(0, 5);
        points.push_back({x + dx, y + dy, height + slope * dx + sigma * dice.normal()});
    }
    return hypothesis(plane, points, 25);
}

std::size_t count(std::vector<Hypothesis> all)
{
    MergeOptions options;
    options.gap = 0.3;
    options.normal_angle = 0.35;
    return merged(std::move(all), options).size();
}

TEST(Hypotheses, PiecesOfOnePlaneAreOne)
{
    std::vector<Hypothesis> all;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) all.push_back(square(5 * i, 5 * j, 100, 0, static_cast<std::uint64_t>(4 * i + j)));
    EXPECT_EQ(count(all), 1u);
    MergeOptions options;
    options.gap = 0.3;
    options.normal_angle = 0.35;
    const Hypothesis one = merged(all, options)[0];
    EXPECT_DOUBLE_EQ(one.area, 400);
    EXPECT_LT(std::fabs(signed_distance(one.shape, {20, 20, 100})), sigma);
    EXPECT_GT(one.box.extent(0), 19);
    EXPECT_LE(one.some.size(), 2 * hypothesis_points);
}

TEST(Hypotheses, PlanesThatAreParallelInclinedOrApartStayTwo)
{
    EXPECT_EQ(count({square(0, 0, 100, 0, 1), square(5, 0, 100.02, 0, 2)}), 2u);  // ten deviations
    EXPECT_EQ(count({square(0, 0, 100, 0, 1), square(5, 0, 100, 0.01, 2)}), 2u);  // 0.6 degrees
    EXPECT_EQ(count({square(0, 0, 100, 0, 1), square(50, 0, 100, 0, 2)}), 2u);    // 45 away
    EXPECT_EQ(count({square(0, 0, 100, 0, 1), square(5.2, 0, 100, 0, 2)}), 1u);
}

// A sphere as wide as a tank fits a band of it as well as the tank does.
TEST(Hypotheses, WhatALargerShapeExplainsIsNoneOfItsOwn)
{
    Dice dice(4);
    pcm::Shape tank, ball;
    tank.kind = ShapeKind::cylinder;
    tank.radius = 3;
    ball = tank;
    ball.kind = ShapeKind::sphere;
    ball.point = {0, 0, 2};
    std::vector<Vec3d> all, band;
    for (int i = 0; i < 2000; ++i) {
        const SurfacePoint p = point_on(tank, 5, 2 * pi, sigma, dice);
        all.push_back(p.position);
        if (std::fabs(p.position[2] - 2) < 0.15) band.push_back(p.position);
    }
    ASSERT_GT(band.size(), 50u);
    EXPECT_EQ(count({hypothesis(tank, all, 90), hypothesis(ball, band, 5)}), 1u);
    EXPECT_EQ(count({hypothesis(ball, band, 5), hypothesis(tank, all, 90)}), 1u);
    // A sphere elsewhere stays.
    ball.point = {0, 0, 20};
    for (Vec3d& p : band) p[2] += 18;
    EXPECT_EQ(count({hypothesis(tank, all, 90), hypothesis(ball, band, 5)}), 2u);
}

TEST(Hypotheses, WhatIsBroughtTogetherReachesAsFarAsBoth)
{
    Hypothesis one = square(0, 0, 100, 0, 1), other = square(5, 0, 100, 0, 2);
    one.area = 30;
    other.reach = 0.7;
    other.threshold = 2 * threshold;
    MergeOptions options;
    options.gap = 0.3;
    options.normal_angle = 0.35;
    const std::vector<Hypothesis> both = merged({one, other}, options);
    ASSERT_EQ(both.size(), 1u);
    EXPECT_EQ(both[0].reach, 0.7);
    EXPECT_EQ(both[0].threshold, 2 * threshold);
}

// Few points of the larger one: a fit to all leaves them three deviations off.
TEST(Hypotheses, BothMustLieOnTheSurfaceThatIsFittedToAll)
{
    Hypothesis few = square(0, 0, 100.006, 0, 1);
    few.some.resize(20);
    few.area = 30;
    EXPECT_EQ(count({few, square(5, 0, 100, 0, 2)}), 2u);
}

TEST(Hypotheses, AStripAcrossASurfaceStays)
{
    Dice dice(7);
    pcm::Shape plane;
    plane.point = {2, 2, 100};
    plane.axis = {1, 0, 0};
    std::vector<Vec3d> points;
    for (int i = 0; i < 200; ++i) points.push_back({2, dice.between(0, 5), 100 + dice.between(-0.003, 0.003)});
    EXPECT_EQ(count({square(0, 0, 100, 0, 1), hypothesis(plane, points, 1)}), 2u);
}

// A ball so large that it is flat here.
TEST(Hypotheses, NothingIsExplainedBeyondAShapesReach)
{
    Dice dice(7);
    pcm::Shape ball;
    ball.kind = ShapeKind::sphere;
    ball.radius = 1e6;
    ball.point = {10, 0, 100 - 1e6};
    const auto strip = [&](double from, double to) {
        std::vector<Vec3d> points;
        for (int i = 0; i < 200; ++i)
            points.push_back({dice.between(from, to), dice.between(0, 1), 100 + sigma * dice.normal()});
        return hypothesis(ball, points, 20);
    };
    EXPECT_EQ(count({square(0, 0, 100, 0, 1), strip(1, 4)}), 1u);
    EXPECT_EQ(count({square(0, 0, 100, 0, 1), strip(4, 24)}), 2u);
}

// Shapes far from each other are not compared: squares of a wall of storeys, each continued by the next one.
TEST(Hypotheses, ComparesNeighboursAlone)
{
    for (const int shapes : {300, 3000, 30000}) {
        Dice dice(9);
        std::vector<Hypothesis> all;
        for (int i = 0; i < shapes; ++i) {
            Hypothesis one = square(5 * (i / 2 % 100 * 2 + i % 2), 10 * (i / 200), 100 + 0.5 * (i / 2 % 7), 0, 11);
            one.some.resize(8);
            one.area = dice.between(20, 30);
            all.push_back(std::move(one));
        }
        MergeOptions options;
        options.gap = 0.3;
        options.normal_angle = 0.35;
        std::uint64_t pairs = 0;
        EXPECT_EQ(merged(std::move(all), options, &pairs).size(), static_cast<std::size_t>(shapes / 2));
        EXPECT_GE(pairs, static_cast<std::uint64_t>(shapes / 2)) << "each has one that continues it";
        EXPECT_LE(pairs, static_cast<std::uint64_t>(3 * shapes)) << shapes << " shapes";
    }
}

// What has grown is compared with what it reaches now: all in one pass. Each pass compares all with the post, too.
TEST(Hypotheses, WhatHasGrownReachesFarther)
{
    std::vector<Hypothesis> all;
    Hypothesis post = square(0, 0, 100, 0, 9);
    post.shape.kind = ShapeKind::cylinder;
    post.shape.radius = 0.1;
    post.box.extend(Vec3d{30, 5, 110});
    post.area = 1000;
    all.push_back(post);
    for (int i = 0; i < 6; ++i) {
        all.push_back(square(5 * i, 0, 100, 0, static_cast<std::uint64_t>(i)));
        all.back().area = 30 - i;
    }
    MergeOptions options;
    options.gap = 0.3;
    options.normal_angle = 0.35;
    std::uint64_t pairs = 0;
    EXPECT_EQ(merged(std::move(all), options, &pairs).size(), 2u);
    EXPECT_EQ(pairs, 6u + 5u + 1u);
}

}  // namespace
