// Growth of shapes, with least squares to all points reached.

#include "pcm/place/grow_shape.h"

#include "pcm/place/cover_points.h"
#include "pcm/place/refit.h"
#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.003;
constexpr Vec3d map{500123.4, 4800567.8, 100};

pcm::Shape pipe_shape()
{
    pcm::Shape shape;
    shape.kind = ShapeKind::cylinder;
    shape.point = map;
    shape.axis = normalised({0.9, -0.3, 0.1});
    shape.radius = 0.5;
    return shape;
}

// A pipe of 20 units, seen from one side, over a floor and among clutter.
class GrowShapeTest : public testing::Test {
protected:
    void SetUp() override
    {
        Dice dice(3);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 30000; ++i) points.push_back(point_on(pipe_, 20, pi, sigma, dice));
        Shape floor;
        floor.point = map - Vec3d{0, 0, 3};
        for (int i = 0; i < 20000; ++i) points.push_back(point_on(floor, 20, 0, sigma, dice));
        for (int i = 0; i < 8000; ++i) points.push_back({map + dice.between(1, 20) * dice.direction(), {}});
        tree_ = build_surface_tree(folder_.path(), points);
        seeds_ = std::make_unique<PointSet>(set_where(
            tree_, [&](const Vec3d& p) { return distance_to(pipe_, p) < 0.01 && std::fabs(along(p) - 3) < 0.3; }));
        options_.threshold = 0.012;
        options_.step = 0.2;
    }
    double along(const Vec3d& p) const { return dot(p - pipe_.point, pipe_.axis); }
    // As a fit to the seeds would be: off by more than all points allow.
    Shape start() const
    {
        Shape shape = pipe_;
        shape.point = pipe_.point + 3 * pipe_.axis;
        shape.axis = normalised(pipe_.axis + Vec3d{0.002, 0.003, -0.002});
        shape.radius = 0.503;
        return shape;
    }

    TemporaryFolder folder_;
    const Shape pipe_ = pipe_shape();
    std::shared_ptr<const Tree> tree_;
    std::unique_ptr<PointSet> seeds_;
    GrowShapeOptions options_;
};

TEST_F(GrowShapeTest, FollowsThePipeToItsEndsAndFitsAllOfIt)
{
    ASSERT_GT(seeds_->size(), 500u);
    const GrownShape grown = grow_shape(start(), *seeds_, options_);
    EXPECT_EQ(grown.fit.verdict, FitVerdict::good) << grown.fit.message;
    EXPECT_TRUE(grown.converged);
    EXPECT_GT(grown.rounds, 1u);
    EXPECT_EQ(grown.agreement, 1);
    EXPECT_EQ(grown.fit.inliers, grown.points.size());
    const ShapeErrors& errors = grown.fit.errors;
    EXPECT_LT(std::fabs(grown.fit.shape.radius - pipe_.radius), 4 * errors.radius);
    EXPECT_LT(length(cross(grown.fit.shape.axis, pipe_.axis)), 4 * errors.angle);
    EXPECT_LT(errors.radius, 0.0001);
    EXPECT_NEAR(grown.fit.noise, sigma, 0.05 * sigma);
    // A threshold of four sigma: all but a few of the pipe's points, and few others.
    const PointSet near = set_where(
        tree_, [&](const Vec3d& p) { return distance_to(pipe_, p) < 4 * sigma && along(p) > 0 && along(p) < 20; });
    PointSet both = near;
    both.combine(SetOperation::intersect, grown.points);
    EXPECT_GT(both.size(), 29900u);
    EXPECT_LT(grown.points.size(), 30100u);
}

TEST_F(GrowShapeTest, DependsNeitherOnThreadsNorOnMemory)
{
    options_.threads = 1;
    const GrownShape one = grow_shape(start(), *seeds_, options_);
    options_.threads = 3;
    options_.memory_bytes = 1;
    const GrownShape other = grow_shape(start(), *seeds_, options_);
    EXPECT_TRUE(one.points == other.points);
    EXPECT_EQ(one.fit.shape.point, other.fit.shape.point);
    EXPECT_EQ(one.fit.shape.axis, other.fit.shape.axis);
    EXPECT_EQ(one.fit.shape.radius, other.fit.shape.radius);
    EXPECT_EQ(one.fit.errors.radius, other.fit.errors.radius);
    EXPECT_EQ(one.rounds, other.rounds);
}

TEST_F(GrowShapeTest, WithoutRoundsTheShapeStays)
{
    options_.most_rounds = 0;
    const Shape shape = start();
    const GrownShape grown = grow_shape(shape, *seeds_, options_);
    EXPECT_EQ(grown.rounds, 0u);
    EXPECT_EQ(grown.fit.shape.radius, shape.radius);
    EXPECT_EQ(grown.fit.shape.axis, shape.axis);
    EXPECT_GT(grown.points.size(), seeds_->size());
    EXPECT_TRUE(points_on_shape(tree_, shape, options_.threshold, pi, {}).size() >= grown.points.size());
}

// After one round the shape is another one than that by which points were reached.
TEST_F(GrowShapeTest, WithoutConvergenceThePointsAreThoseOfTheShape)
{
    options_.most_rounds = 1;
    const GrownShape grown = grow_shape(start(), *seeds_, options_);
    EXPECT_FALSE(grown.converged);
    EXPECT_EQ(grown.rounds, 1u);
    ASSERT_GT(grown.points.size(), 20000u);
    EXPECT_EQ(grown.fit.inliers, grown.points.size());
    for (const PlacedPoint& p : all_points(*tree_))
        if (grown.points.contains(p.node, p.number))
            ASSERT_LE(distance_to(grown.fit.shape, p.position), options_.threshold);
}

// Where noise is larger than at the place that the threshold came from.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(GrowShapeTest, PCM_NOT_UNDER_THREAD(RaisesTheThresholdToTheNoise))
{
    options_.threshold = 1.5 * sigma;
    const GrownShape narrow = grow_shape(start(), *seeds_, options_);
    options_.raise_threshold = true;
    const GrownShape raised = grow_shape(start(), *seeds_, options_);
    EXPECT_LT(narrow.points.size(), 27000u);
    EXPECT_GT(raised.points.size(), 29500u);
    EXPECT_GT(raised.fit.threshold, 2.5 * sigma);
    EXPECT_LE(raised.fit.threshold, 2.5 * options_.threshold);
}

// A face of 1 x 2 and a wall across its border, which the threshold of a neighbourhood of both takes in.
TEST(GrowShape, LowersAThresholdThatTakesInAnotherSurface)
{
    constexpr double noise = 0.0015;
    Dice dice(4);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 8000; ++i)
        points.push_back({map + Vec3d{dice.between(0, 1), dice.between(0, 2), noise * dice.normal()}, {}});
    for (int i = 0; i < 8000; ++i)
        points.push_back({map + Vec3d{noise * dice.normal(), dice.between(0, 2), dice.between(0, 0.3)}, {}});
    TemporaryFolder folder;
    const auto tree = build_surface_tree(folder.path(), points);
    pcm::Shape plane;
    plane.point = map + Vec3d{0.5, 1, 0};
    const PointSet seeds = set_where(tree, [&](const Vec3d& p) { return length(p - plane.point) < 0.1; });
    GrowShapeOptions options;
    options.threshold = 20 * noise;
    options.step = 0.1;
    for (const bool lower : {false, true}) {
        options.lower_threshold = lower;
        const GrownShape grown = grow_shape(plane, seeds, options);
        if (lower)
            EXPECT_TRUE(grown.threshold > 3 * noise && grown.threshold < 4.5 * noise) << grown.threshold;
        else
            EXPECT_EQ(grown.threshold, options.threshold);
        EXPECT_EQ(grown.fit.threshold, grown.threshold);
        PointSet far = set_where(tree, [&](const Vec3d& p) { return p[2] - map[2] > 6 * noise; });
        far.combine(SetOperation::intersect, grown.points);
        EXPECT_EQ(far.size() > 100, !lower) << far.size();
        EXPECT_GT(grown.points.size(), 7800u);
    }
    // What is no wider than noise stays.
    options.lower_threshold = true;
    options.threshold = 4 * noise;
    EXPECT_EQ(grow_shape(plane, seeds, options).threshold, options.threshold);
}

TEST_F(GrowShapeTest, SeedsOffTheSurfaceReachNothing)
{
    Shape far = pipe_;
    far.point = pipe_.point + Vec3d{0, 0, 2};
    const GrownShape grown = grow_shape(far, *seeds_, options_);
    EXPECT_TRUE(grown.points.empty());
    EXPECT_FALSE(grown.fit.has_shape());
    EXPECT_FALSE(grown.fit.message.empty());
}

TEST_F(GrowShapeTest, OptionsOutOfRangeAreRefused)
{
    for (double GrowShapeOptions::*number : {&GrowShapeOptions::threshold, &GrowShapeOptions::step})
        for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
            GrowShapeOptions options = options_;
            options.*number = bad;
            EXPECT_THROW(grow_shape(pipe_, *seeds_, options), Error);
        }
}

TEST_F(GrowShapeTest, CanBeCancelledAtAnyTime)
{
    int calls = 0;
    double last = 0;
    options_.progress = [&](const ProgressUpdate& update) {
        ++calls;
        EXPECT_GE(update.fraction, last - 1e-12);
        EXPECT_LE(update.fraction, 1);
        last = update.fraction;
        return true;
    };
    grow_shape(start(), *seeds_, options_);
    ASSERT_GT(calls, 4);
    for (int at = 1; at <= calls; at += 1 + calls / 7) {
        int left = at;
        options_.progress = [&](const ProgressUpdate&) { return --left > 0; };
        try {
            grow_shape(start(), *seeds_, options_);
            EXPECT_GT(left, 0);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::cancelled);
        }
    }
}

// A wave on the surface is not noise: neighbours agree, and the errors are those of fewer points.
// The visible half of a beam's flange, 75 mm wide, between its edge and the web, which rise from it to opposite sides:
// most of the flange is next to these, and their points within the threshold turn the plane.
GrownShape grown_narrow_face(double width)
{
    constexpr double noise = 0.0015;
    Dice dice(21);
    std::vector<SurfacePoint> points;
    const auto put = [&](double x, double z) {
        points.push_back({map + Vec3d{x, dice.between(0, 2.4), z + noise * dice.normal()}, {}});
    };
    for (int i = 0; i < 16000 * width; ++i) put(dice.between(0, width), 0);
    for (int i = 0; i < 300; ++i) put(noise * dice.normal(), dice.between(-0.012, 0));
    for (int i = 0; i < 1800; ++i) put(width + noise * dice.normal(), dice.between(0, 0.09));
    TemporaryFolder folder;
    const auto tree = build_surface_tree(folder.path(), points);
    GrowShapeOptions options;
    options.threshold = 3 * noise;
    options.step = 0.12;
    pcm::Shape plane;
    plane.point = map + Vec3d{width / 2, 1.2, 0};
    return grow_shape(plane, set_where(tree, [&](const Vec3d& p) { return distance_to(plane, p) < options.threshold; }),
                      options);
}

double turned_from_z(const GrownShape& grown) { return std::acos(std::min(1.0, std::fabs(grown.fit.shape.axis[2]))); }

TEST(GrowShape, ANarrowFaceIsFittedWithoutItsBorder)
{
    const GrownShape grown = grown_narrow_face(0.075);
    ASSERT_TRUE(grown.fit.has_shape());
    EXPECT_LT(grown.inner_share, 0.5);
    EXPECT_GT(grown.inner_share, 0.05);
    EXPECT_LT(turned_from_z(grown), 0.003) << "with its border it is turned by more than 0.01";
    EXPECT_LT(turned_from_z(grown), 3.44 * grown.fit.errors.angle);
    EXPECT_LT(grown.fit.errors.angle, 0.01);
    EXPECT_EQ(grown.fit.inliers, grown.points.size());
}

// The middle of this one would leave its angle far more uncertain.
TEST(GrowShape, ErrorsContainWhatEdgesDoToANarrowerFace)
{
    const GrownShape grown = grown_narrow_face(0.02);
    ASSERT_TRUE(grown.fit.has_shape());
    EXPECT_GT(turned_from_z(grown), 0.01) << "the edges turn it";
    EXPECT_LT(turned_from_z(grown), 3.44 * grown.fit.errors.angle);
}

TEST(Refit, ErrorsOfNeighboursThatAgreeAreLarger)
{
    TemporaryFolder folder;
    Dice dice(4);
    const Shape pipe = pipe_shape();
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 20000; ++i) {
        SurfacePoint p = point_on(pipe, 4, pi, sigma, dice);
        p.position = p.position + 2 * sigma * std::sin(2.5 * dot(p.position - map, pipe.axis)) * p.normal;
        points.push_back(p);
    }
    const auto tree = build_surface_tree(folder.path(), points);
    RefitOptions options;
    options.threshold = 0.1;
    const RefittedShape fitted = refit_shape(PointSet::all_of(tree), pipe, options);
    EXPECT_GT(fitted.agreement, 4);
    EXPECT_LT(fitted.agreement, 60);
    EXPECT_TRUE(fitted.fit.has_shape());
    EXPECT_GT(fitted.fit.errors.radius, 4 * fitted.fit.noise / std::sqrt(20000.0));
    EXPECT_EQ(fitted.box, tree->info().bounds());
}

// Where the first of several steps of least squares ends, the sums of the second begin.
TEST(Refit, FromAStartAsideAndFromTheTrueShapeOneResult)
{
    Dice dice(6);
    pcm::Shape ball;
    ball.kind = ShapeKind::sphere;
    ball.point = map;
    ball.radius = 0.7;
    for (const Shape& shape : {pipe_shape(), ball}) {
        TemporaryFolder folder;
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 3000; ++i) points.push_back(point_on(shape, 2, 2 * pi, sigma, dice));
        const PointSet all = PointSet::all_of(build_surface_tree(folder.path(), points));
        RefitOptions options;
        options.threshold = 0.1;
        const RefittedShape expected = refit_shape(all, shape, options);
        Shape aside = shape;
        aside.radius *= 1.15;
        aside.point = shape.point + 0.08 * across(shape.axis)[0];
        aside.axis = normalised(shape.axis + 0.05 * across(shape.axis)[1]);
        const RefittedShape found = refit_shape(all, aside, options);
        EXPECT_LT(change_in_errors(expected.fit.shape, found.fit.shape, expected.fit.errors, expected.box.centre()),
                  0.02);
        EXPECT_NEAR(found.fit.rms, expected.fit.rms, 1e-4 * expected.fit.rms);
        EXPECT_NEAR(found.fit.errors.radius, expected.fit.errors.radius, 0.01 * expected.fit.errors.radius);
    }
}

TEST(Refit, ChangesAreMeasuredInErrors)
{
    Shape from = pipe_shape(), to = from;
    const ShapeErrors errors{0.01, 0.001, 0.1, 0};
    EXPECT_EQ(change_in_errors(from, to, errors, map), 0);
    to.point = from.point + 7 * from.axis;  // the same axis
    EXPECT_NEAR(change_in_errors(from, to, errors, map), 0, 1e-6);
    to.radius += 0.3;
    EXPECT_NEAR(change_in_errors(from, to, errors, map), 3, 1e-6);
    to.axis = normalised(from.axis + 0.005 * normalised(cross(from.axis, {0, 0, 1})));
    EXPECT_NEAR(change_in_errors(from, to, errors, to.point), 5, 0.01);
    to = from;
    to.point[2] += 0.1;
    EXPECT_GT(change_in_errors(from, to, errors, map), 9);
    EXPECT_EQ(change_in_errors(from, to, {HUGE_VAL, HUGE_VAL, HUGE_VAL, 0}, map), 0);
    EXPECT_EQ(change_in_errors(from, to, {0, 0, 0, 0}, map), HUGE_VAL);
}

TEST(Refit, APlaneThatPassesToTheOtherSideHasMoved)
{
    const ShapeErrors errors{0.01, 0.001, 0, 0};
    const Shape from = parse_shape("plane 0 0 0.02 0 0 1");
    EXPECT_NEAR(change_in_errors(from, parse_shape("plane 0 0 -0.02 0 0 1"), errors, {}), 4, 1e-9);
    EXPECT_NEAR(change_in_errors(from, parse_shape("plane 5 0 -0.02 0 0 -1"), errors, {}), 4, 1e-9);
    EXPECT_NEAR(change_in_errors(from, parse_shape("plane 0 5 0.02 0 0 -1"), errors, {}), 0, 1e-9);  // the same
}

TEST(CoverPoints, OfManyPointsTheCoarseAndTheOutermostAreGiven)
{
    TemporaryFolder folder;
    Dice dice(5);
    const Shape pipe = pipe_shape();
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 40000; ++i) points.push_back(point_on(pipe, 4, pi, sigma, dice));
    const auto tree = build_surface_tree(folder.path(), points);
    const PointSet all = PointSet::all_of(tree);
    EXPECT_EQ(cover_points(all, pipe).size(), 40000u);
    const std::vector<Vec3d> some = cover_points(all, pipe, 1, {}, 5000);
    EXPECT_GT(some.size(), 1000u);
    EXPECT_LT(some.size(), 12000u);
    EXPECT_EQ(cover_points(all, pipe, 3, {}, 5000), some);
    const auto ends = [&](const std::vector<Vec3d>& list) {
        std::pair<double, double> range{HUGE_VAL, -HUGE_VAL};
        for (const Vec3d& p : list) {
            range.first = std::min(range.first, dot(p - map, pipe.axis));
            range.second = std::max(range.second, dot(p - map, pipe.axis));
        }
        return range;
    };
    EXPECT_EQ(ends(some), ends(cover_points(all, pipe)));
    EXPECT_TRUE(cover_points(PointSet(tree), pipe).empty());
}

TEST(Refit, ASizeIsCertainFromTenErrorsOn)
{
    ShapeFit fit;
    fit.shape.kind = ShapeKind::torus;
    fit.shape.radius = 104;
    fit.shape.second = 0.0445;
    fit.errors.second = 0.0018;
    fit.errors.radius = 10;
    EXPECT_TRUE(is_size_certain(fit));
    fit.errors.radius = 21;
    EXPECT_FALSE(is_size_certain(fit)) << "a lamp post";
    fit.shape.kind = ShapeKind::plane;
    EXPECT_TRUE(is_size_certain(fit));
}

}  // namespace
