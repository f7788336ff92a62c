// From picked places to primitives: on generated surfaces with their exact truth, and on scans.

#include "pcm/place/fit_at.h"

#include "pcm/place/local_fit.h"
#include "pcm/place/refit.h"
#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.003;
constexpr Vec3d map{500123.4, 4800567.8, 100};

pcm::Shape shape_at(ShapeKind kind, const Vec3d& place)
{
    Shape shape;
    shape.kind = kind;
    shape.point = place;
    shape.axis = normalised({0.2, -0.3, 0.9});
    shape.radius = kind == ShapeKind::torus ? 3 : 1;
    shape.second = 0.4;
    return shape;
}

constexpr ShapeKind all_kinds[] = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone,
                                   ShapeKind::torus};

// A surface of each kind, ten units apart, seen from one side, with clutter between.
class FitAt : public testing::Test {
protected:
    void SetUp() override
    {
        Dice dice(11);
        std::vector<SurfacePoint> points;
        for (const ShapeKind kind : all_kinds) {
            for (int i = 0; i < 15000; ++i) {
                points.push_back(point_on(truth(kind), 3, pi, sigma, dice));
                if (i == 0) pick_.push_back(points.back().position);
            }
        }
        for (int i = 0; i < 5000; ++i) points.push_back({map + 30 * dice.unit() * dice.direction(), {}});
        build_surface_tree(folder_.path(), points);
        cloud_ = PointCloud::open(folder_ / "surface.pct");
    }
    static Shape truth(ShapeKind kind) { return shape_at(kind, map + Vec3d{10.0 * static_cast<double>(kind), 0, 0}); }
    const Vec3d& pick(ShapeKind kind) const { return pick_[static_cast<std::size_t>(kind)]; }
    FittedPrimitive fit(const std::vector<Vec3d>& places, const FitAtOptions& options,
                        const std::vector<Vec3d>& not_places = {}) const
    {
        return fit_at(*cloud_, places, not_places, options);
    }
    static FitAtOptions of(ShapeKind kind)
    {
        FitAtOptions options;
        options.fit.kind = kind;
        return options;
    }
    static FitAtOptions of_any()
    {
        FitAtOptions options;
        options.kinds.assign(std::begin(all_kinds), std::end(all_kinds));
        return options;
    }

    // How far the result is from the truth, in its errors; where the points are, a plane's place and an axis'.
    static double change_of(const ShapeFit& result, ShapeKind kind)
    {
        return change_in_errors(result.shape, truth(kind), result.errors, truth(kind).point + 1.5 * truth(kind).axis);
    }

    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
    std::vector<Vec3d> pick_;
};

// Nothing but a place is given.
// Not under the thread sanitizer: many fits, whose threads other tests watch.
TEST_F(FitAt, PCM_NOT_UNDER_THREAD(FindsTheShapeAndItsPoints))
{
    for (const ShapeKind kind : all_kinds)
        for (const bool any : {false, true}) {
            SCOPED_TRACE(std::string(traits_of(kind).name) + (any ? ", any kind" : ""));
            const FittedPrimitive found = fit({pick(kind)}, any ? of_any() : of(kind));
            const ShapeFit& result = found.primitive.fit;
            ASSERT_EQ(result.verdict, FitVerdict::good) << result.message;
            ASSERT_EQ(result.shape.kind, kind);
            EXPECT_LT(change_of(result, kind), 4.5);
            EXPECT_NEAR(result.noise, sigma, 0.1 * sigma);
            EXPECT_GT(found.points.size(), 14600u);
            EXPECT_LT(found.points.size(), 15200u);
            EXPECT_EQ(found.primitive.points, found.points.size());
            EXPECT_EQ(found.primitive.estimator, "msac");
            EXPECT_TRUE(found.primitive.bounds.known(kind));
            EXPECT_TRUE(result.is_inlier.empty());
            EXPECT_TRUE(found.converged);
            EXPECT_GT(found.rounds, 0u);
            EXPECT_GT(result.seconds, 0);
        }
}

TEST_F(FitAt, PCM_NOT_UNDER_THREAD(WhatIsGivenIsTaken))
{
    FitAtOptions options = of(ShapeKind::cylinder);
    options.grow = false;
    options.count = 700;
    options.fit.threshold = 0.011;
    FittedPrimitive found = fit({pick(ShapeKind::cylinder)}, options);
    EXPECT_EQ(found.near.ids.size(), 700u);
    EXPECT_EQ(found.primitive.fit.threshold, 0.011);
    EXPECT_EQ(found.rounds, 0u);
    EXPECT_LE(found.points.size(), 700u);
    EXPECT_GT(found.points.size(), 600u);
    EXPECT_EQ(found.points.size(), found.local.inliers);
    options.count = 0;
    options.radius = 0.5;
    found = fit({pick(ShapeKind::cylinder)}, options);
    EXPECT_EQ(found.near.radius, 0.5);
    for (std::size_t i = 0; i < found.near.ids.size(); ++i)
        ASSERT_LE(length(found.near.points.source(i) - pick(ShapeKind::cylinder)), 0.5 + 1e-9);
    options.grow = true;
    options.step = 0.25;
    EXPECT_EQ(fit({pick(ShapeKind::cylinder)}, options).step, 0.25);
}

// Growth stops where the person says that the shape is not.
TEST_F(FitAt, PCM_NOT_UNDER_THREAD(PlacesThatAreNotPartOfItAreLeftOut))
{
    const Shape pipe = truth(ShapeKind::cylinder);
    const auto [u, v] = across(pipe.axis);
    const Vec3d at = pipe.point + 0.5 * pipe.axis + v, not_at = pipe.point + 2.2 * pipe.axis + v;
    const FittedPrimitive whole = fit({at}, of(ShapeKind::cylinder));
    EXPECT_NEAR(whole.step, 0.5, 0.001);  // half the radius: more than the gaps ask for
    FitAtOptions options = of(ShapeKind::cylinder);
    options.radius = 0.3;
    const FittedPrimitive part = fit({at}, options, {not_at});
    EXPECT_LT(part.points.size(), whole.points.size());
    std::size_t inside = 0;
    for (const PlacedPoint& p : all_points(part.points.tree()))
        if (part.points.contains(p.node, p.number)) inside += length(p.position - not_at) <= 0.3;
    EXPECT_EQ(inside, 0u);
    // Next to the place the ball reaches half the way at most.
    options.radius = 3;
    const Vec3d nearby = at + 0.2 * pipe.axis;
    const FittedPrimitive near = fit({at}, options, {nearby});
    EXPECT_GT(near.points.size(), 5000u);
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < near.near.ids.size(); ++i)
        nearest = std::min(nearest, length(near.near.points.source(i) - nearby));
    EXPECT_GT(nearest, 0.0999);
    EXPECT_LT(nearest, 0.15);
    EXPECT_THROW(fit({at}, options, {at}), Error);
}

TEST_F(FitAt, PCM_NOT_UNDER_THREAD(MorePlacesRefineIt))
{
    const Shape pipe = truth(ShapeKind::cylinder);
    const auto [u, v] = across(pipe.axis);
    FitAtOptions options = of(ShapeKind::cylinder);
    options.count = 60;
    options.grow = false;
    const FittedPrimitive one = fit({pipe.point + 1.5 * pipe.axis + v}, options);
    const FittedPrimitive three =
        fit({pipe.point + 0.2 * pipe.axis + v, pipe.point + 1.5 * pipe.axis + u, pipe.point + 2.8 * pipe.axis + v},
            options);
    ASSERT_TRUE(three.primitive.fit.has_shape())
        << three.primitive.fit.message << " " << three.local.message << three.local.threshold;
    EXPECT_EQ(three.near.ids.size(), 180u);
    EXPECT_LT(three.primitive.fit.errors.radius, one.primitive.fit.errors.radius);
    // The same place twice is one.
    EXPECT_EQ(fit({pick(ShapeKind::sphere), pick(ShapeKind::sphere)}, options).near.ids.size(), 60u);
}

TEST_F(FitAt, PCM_NOT_UNDER_THREAD(OnlyWhatTheLimitChoosesTakesPart))
{
    FitAtOptions options = of(ShapeKind::cylinder);
    const Shape pipe = truth(ShapeKind::cylinder);
    options.limit.clips.push_back({Region::sphere(pick(ShapeKind::cylinder), 0.8), false});
    const FittedPrimitive found = fit({pick(ShapeKind::cylinder)}, options);
    ASSERT_TRUE(found.primitive.fit.has_shape());
    for (const PlacedPoint& p : all_points(found.points.tree()))
        if (found.points.contains(p.node, p.number))
            ASSERT_LE(length(p.position - pick(ShapeKind::cylinder)), 0.8 + 1e-6);
    options.limit.where.push_back(parse_condition("nothing=1"));
    EXPECT_THROW(fit({pick(ShapeKind::cylinder)}, options), Error);
}

// In the air and far away the nearest points are taken, and a note has the distance; a radius without points is
// refused. Under no sanitizer: minutes there, of what other tests run too.
TEST_F(FitAt, PCM_NOT_UNDER_SANITIZERS(PlacesOffTheCloud))
{
    const Shape ball = truth(ShapeKind::sphere);
    const Vec3d air = pick(ShapeKind::sphere) + 0.5 * normal_at(ball, pick(ShapeKind::sphere));
    FittedPrimitive found = fit({air}, of(ShapeKind::sphere));
    EXPECT_TRUE(found.primitive.fit.has_shape());
    const auto says = [&](const std::string& part) {
        return std::any_of(found.notes.begin(), found.notes.end(),
                           [&](const std::string& note) { return note.find(part) != std::string::npos; });
    };
    EXPECT_TRUE(says("from the nearest point"));
    EXPECT_NO_THROW(fit({{0, 0, 0}}, of(ShapeKind::sphere)));
    EXPECT_NO_THROW(fit({{1e15, -1e15, 1e9}}, of_any()));
    FitAtOptions options = of(ShapeKind::sphere);
    options.radius = 1;
    found = fit({map + Vec3d{500, 0, 0}}, options);
    EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::refused);
    EXPECT_EQ(found.primitive.fit.issue, FitIssue::too_few_points);
    EXPECT_TRUE(found.points.empty());
    EXPECT_TRUE(says("from the nearest point"));
    options.limit.box = Box3d{{1, 1, 1}, {2, 2, 2}};
    found = fit({map}, options);
    EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::refused);
    EXPECT_TRUE(says("no point"));
}

TEST_F(FitAt, PCM_NOT_UNDER_THREAD(OptionsOutOfRangeAreRefused))
{
    const Vec3d at = pick(ShapeKind::sphere);
    const auto refused = [&](const std::vector<Vec3d>& places, const FitAtOptions& options) {
        try {
            fit(places, options);
        } catch (const Error& error) {
            return error.code() == ErrorCode::invalid_argument;
        }
        return false;
    };
    EXPECT_TRUE(refused({}, of_any()));
    EXPECT_TRUE(refused({{std::nan(""), 0, 0}}, of_any()));
    FitAtOptions both = of_any();
    both.radius = 1;
    both.count = 5;
    EXPECT_TRUE(refused({at}, both));
    for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
        FitAtOptions options = of_any();
        options.step = bad;
        EXPECT_TRUE(refused({at}, options));
        options = of_any();
        options.radius = bad;
        EXPECT_TRUE(refused({at}, options));
        options = of_any();
        options.fit.threshold = bad;
        EXPECT_TRUE(refused({at}, options));
    }
    FitAtOptions options = of_any();
    options.fit.probability = 1;
    EXPECT_TRUE(refused({at}, options));
}

// Before it is followed, which takes most of the time, and before wider neighbourhoods are looked at; no more often,
// although the pipe is followed with two thresholds.
TEST_F(FitAt, PCM_NOT_UNDER_THREAD(TheShapeAtThePlaceIsGivenFirst))
{
    int calls = 0;
    double fraction = 0;
    std::uint64_t points = 0, first_points = 0;
    FitAtOptions options = of_any();
    options.progress = [&](const ProgressUpdate& update) { return fraction = update.fraction, true; };
    options.found_at_place = [&](const Primitive& found) {
        ++calls;
        EXPECT_LT(fraction, calls == 1 ? 0.06 : 0.25);
        EXPECT_EQ(found.fit.shape.kind, ShapeKind::cylinder);
        EXPECT_TRUE(found.bounds.known(ShapeKind::cylinder));
        points = found.points;
        if (calls == 1) first_points = points;
    };
    const FittedPrimitive found = fit({pick(ShapeKind::cylinder)}, options);
    EXPECT_EQ(calls, 2) << "for 500 points, and for the neighbourhood that was widened";
    EXPECT_LE(first_points, 500u);
    EXPECT_EQ(points, found.local.inliers);
    EXPECT_GT(found.points.size(), 3 * points);
    options.grow = false;
    fit({pick(ShapeKind::cylinder)}, options);
    EXPECT_EQ(calls, 2) << "the answer is that shape";
}

TEST_F(FitAt, PCM_NOT_UNDER_THREAD(WhenTheTimeIsOverTheShapeIsThatOfThePlace))
{
    FitAtOptions options = of(ShapeKind::cylinder);
    const FittedPrimitive whole = fit({pick(ShapeKind::cylinder)}, options);
    options.fit.seconds = 1000;
    EXPECT_EQ(fit({pick(ShapeKind::cylinder)}, options).primitive.fit.shape.radius, whole.primitive.fit.shape.radius);
    options.fit.seconds = 1e-9;
    const FittedPrimitive found = fit({pick(ShapeKind::cylinder)}, options);
    EXPECT_EQ(found.left_surface, "the time limit of 1e-09 s was over");
    EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(found.primitive.fit.message.find("points around the place alone"), std::string::npos);
    EXPECT_EQ(found.points.size(), found.local.inliers);
    EXPECT_LE(found.near.found, 500u) << "wider neighbourhoods are not looked at any more";
    EXPECT_TRUE(found.primitive.bounds.known(ShapeKind::cylinder));
    EXPECT_EQ(found.reached.turned_angle, whole.reached.turned_angle);
    EXPECT_LT(std::fabs(found.primitive.fit.shape.radius - whole.primitive.fit.shape.radius),
              4 * found.primitive.fit.errors.radius);
    options.grow = false;
    EXPECT_EQ(fit({pick(ShapeKind::cylinder)}, options).left_surface, "") << "it was not to be followed";
}

TEST_F(FitAt, PCM_NOT_UNDER_THREAD(CanBeCancelledAtAnyTime))
{
    FitAtOptions options = of_any();
    int calls = 0;
    double last = 0;
    options.progress = [&](const ProgressUpdate& update) {
        ++calls;
        EXPECT_GE(update.fraction, last - 1e-9) << update.stage;
        last = std::max(last, update.fraction);
        return true;
    };
    fit({pick(ShapeKind::cylinder)}, options);
    ASSERT_GT(calls, 10);
    EXPECT_LE(last, 1);
    for (int at = 1; at <= calls; at += 1 + calls / 12) {
        int left = at;
        options.progress = [&](const ProgressUpdate&) { return --left > 0; };
        try {
            fit({pick(ShapeKind::cylinder)}, options);
            EXPECT_GT(left, 0) << at;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::cancelled);
        }
    }
}

TEST_F(FitAt, PCM_NOT_UNDER_THREAD(TheSameGivesTheSame))
{
    FitAtOptions options = of_any();
    options.threads = 1;
    const FittedPrimitive one = fit({pick(ShapeKind::torus)}, options);
    options.threads = 3;
    options.memory_bytes = 1;
    const FittedPrimitive other = fit({pick(ShapeKind::torus)}, options);
    EXPECT_EQ(text_of(one.primitive.fit.shape), text_of(other.primitive.fit.shape));
    EXPECT_TRUE(one.points == other.points);
    EXPECT_EQ(one.primitive.bounds.begin, other.primitive.bounds.begin);
}

TEST(AutomaticStep, PassesTheGapsBetweenScanLines)
{
    std::vector<Vec3d> lines;
    for (int line = 0; line < 20; ++line)
        for (int k = 0; k < 100; ++k) lines.push_back({0.01 * k, 0.1 * line, 0});
    EXPECT_NEAR(automatic_step(lines), 0.4, 1e-9);
    // A tenth may be far from the others.
    for (int k = 0; k < 100; ++k) lines.push_back({50 + 0.01 * k, 0, 0});
    EXPECT_NEAR(automatic_step(lines), 0.4, 1e-9);
    EXPECT_EQ(automatic_step({}), 0);
    EXPECT_EQ(automatic_step({{1, 2, 3}}), 0);
    EXPECT_EQ(automatic_step({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}), 0);
}

}  // namespace
