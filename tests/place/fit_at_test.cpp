// From picked places to primitives: on generated surfaces with their exact truth, and on scans.

#include "pcm/place/fit_at.h"

#include "pcm/place/local_fit.h"
#include "pcm/place/refit.h"
#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

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

// Before it is followed, which takes most of the time; once, although the pipe is followed with two thresholds.
TEST_F(FitAt, PCM_NOT_UNDER_THREAD(TheShapeAtThePlaceIsGivenFirst))
{
    int calls = 0;
    double fraction = 0;
    std::uint64_t points = 0;
    FitAtOptions options = of_any();
    options.progress = [&](const ProgressUpdate& update) { return fraction = update.fraction, true; };
    options.found_at_place = [&](const Primitive& found) {
        ++calls;
        EXPECT_LT(fraction, 0.25);
        EXPECT_EQ(found.fit.shape.kind, ShapeKind::cylinder);
        EXPECT_TRUE(found.bounds.known(ShapeKind::cylinder));
        points = found.points;
    };
    const FittedPrimitive found = fit({pick(ShapeKind::cylinder)}, options);
    EXPECT_EQ(calls, 1);
    EXPECT_EQ(points, found.local.inliers);
    EXPECT_GT(found.points.size(), 3 * points);
    options.grow = false;
    fit({pick(ShapeKind::cylinder)}, options);
    EXPECT_EQ(calls, 1) << "the answer is that shape";
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

// Scans of real things, against what their owners or others published of them (GROUND_TRUTH.csv); nothing but a place
// is given unless stated otherwise.
class FitScan : public testing::Test {
protected:
    std::shared_ptr<PointCloud> open(const std::string& name)
    {
        build_tree({sample(name)}, folder_ / "scan.pct", {});
        return PointCloud::open(folder_ / "scan.pct");
    }
    static FittedPrimitive fit(const PointCloud& cloud, ShapeKind kind, const Vec3d& place, double threshold = 0)
    {
        FitAtOptions options;
        options.fit.kind = kind;
        options.fit.threshold = threshold;
        return fit_at(cloud, {place}, {}, options);
    }
    static Vec3d line(const std::string& name, int number)
    {
        std::ifstream file(sample(name));
        std::string text;
        for (int i = 0; i <= number; ++i) std::getline(file, text);
        std::istringstream words(text);
        Vec3d p{};
        words >> p[0] >> p[1] >> p[2];
        return p;
    }
    TemporaryFolder folder_;
};

// Not under the thread sanitizer: many fits, whose threads other tests watch.
TEST_F(FitScan, PCM_NOT_UNDER_THREAD(MugAndTable))
{
    const std::string name = "primitives/table_scene_mug_stereo_textured.pcd";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    for (const Vec3d& place : {Vec3d{0.063, 0.078, 0.735}, Vec3d{0.05, 0.08, 0.73}, Vec3d{0.03, 0.06, 0.735}}) {
        const FittedPrimitive mug = fit(*cloud, ShapeKind::cylinder, place);
        ASSERT_TRUE(mug.primitive.fit.has_shape());
        EXPECT_NEAR(mug.primitive.fit.shape.radius, 0.0396, 0.001);
        EXPECT_GT(mug.points.size(), 9000u);
        EXPECT_FALSE(mug.notes.empty());  // neighbours agree
    }
    const FittedPrimitive table = fit(*cloud, ShapeKind::plane, {0.2, 0, 0.97});
    ASSERT_EQ(table.primitive.fit.verdict, FitVerdict::good);
    const Vec3d normal{-0.0161854, 0.837724, 0.545855};
    EXPECT_LT(length(cross(table.primitive.fit.shape.axis, normalised(normal))), 0.5 * pi / 180);
    const Shape published{ShapeKind::plane, 0.528787 / dot(normal, normal) * normal, normalised(normal), 0, 0};
    Vec3d middle{};
    for (const Vec3d& corner : table.primitive.bounds.outline) middle = middle + 0.25 * corner;
    EXPECT_LT(distance_to(published, middle), 0.002);
    EXPECT_GT(table.points.size(), 100000u);
}

TEST_F(FitScan, PCM_NOT_UNDER_THREAD(TangoScene))
{
    const std::string name = "primitives/curvsurf_tango_scene.xyz";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    const FittedPrimitive cylinder = fit(*cloud, ShapeKind::cylinder, line(name, 3437));
    EXPECT_EQ(cylinder.primitive.fit.verdict, FitVerdict::good);
    EXPECT_NEAR(cylinder.primitive.fit.shape.radius, 0.0667, 0.0032);
    // The published radius is of all points within 10 mm, among them the table's. Ours leaves these out: it does not
    // depend on the threshold, while that of all points grows from 62 mm at 2 mm to 87 mm at 15 mm.
    double least = HUGE_VAL, largest = 0;
    for (const double threshold : {0.004, 0.007, 0.010, 0.015}) {
        const double radius = fit(*cloud, ShapeKind::cylinder, line(name, 3437), threshold).primitive.fit.shape.radius;
        least = std::min(least, radius);
        largest = std::max(largest, radius);
    }
    EXPECT_GT(least, 0.0642);
    EXPECT_LT(largest, 0.0652);
    EXPECT_LT(length(cross(cylinder.primitive.fit.shape.axis, normalised({-0.0255, 0.8618, 0.5066}))), 0.03);
    const FittedPrimitive sphere = fit(*cloud, ShapeKind::sphere, line(name, 7811), 0.005);  // as its truth
    const FittedPrimitive by_default = fit(*cloud, ShapeKind::sphere, line(name, 7811));
    for (const ShapeFit& ball : {sphere.primitive.fit, by_default.primitive.fit}) {
        EXPECT_EQ(ball.verdict, FitVerdict::good);
        EXPECT_GT(ball.shape.radius, 0.0785);
        EXPECT_LT(ball.shape.radius, 0.085);
        // The published centre has radii from 80.5 to 83 mm: it is not known more exactly.
        EXPECT_LT(length(ball.shape.point - Vec3d{0.100, -0.070, -0.968}), 0.0025);
    }
    const FittedPrimitive cone = fit(*cloud, ShapeKind::cone, line(name, 6637));
    EXPECT_TRUE(cone.primitive.fit.has_shape());
    EXPECT_GT(cone.points.size(), 250u);
    const FittedPrimitive torus = fit(*cloud, ShapeKind::torus, line(name, 7384));
    EXPECT_TRUE(torus.primitive.fit.has_shape());
    EXPECT_GT(torus.points.size(), 700u);
    RecordProperty("cone_half_angle_degrees", std::to_string(cone.primitive.fit.shape.second * 180 / pi));
    RecordProperty("torus_radius", std::to_string(torus.primitive.fit.shape.radius));
    RecordProperty("torus_tube", std::to_string(torus.primitive.fit.shape.second));
}

// A scan by a scanner that was carried: neighbours share errors, and noise differs from place to place. The ceiling
// hangs through by some millimetres, so that a cylinder of 250 m explains it better, but not what neighbours share. Of
// the wall the first threshold cuts the noise. Before, doubtful patches around the places.
TEST_F(FitScan, PCM_NOT_UNDER_SANITIZERS(CeilingAndWallOfAnIndoorScan))
{
    const std::string name = "las/indoor.laz";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    FitAtOptions options;
    for (const ShapeTraits& row : shape_kinds()) options.kinds.push_back(row.kind);
    const auto at = [&](const Vec3d& place) { return fit_at(*cloud, {place}, {}, options); };
    const FittedPrimitive ceiling = at({-7.07000, 5.03000, 2.59000}), wall = at({2.48000, -1.66000, 4.31000});
    for (const FittedPrimitive* plane : {&ceiling, &wall}) {
        EXPECT_EQ(plane->primitive.fit.verdict, FitVerdict::good) << plane->primitive.fit.message;
        EXPECT_EQ(plane->primitive.fit.shape.kind, ShapeKind::plane);
    }
    EXPECT_GT(ceiling.points.size(), 15000u);
    EXPECT_GT(wall.points.size(), 3300u);
}

// Labels of the file say how many points the table has (141,517), and which are on a box and on two equal cans.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(FitScan, PCM_NOT_UNDER_SANITIZERS(TableBoxAndCans))
{
    const std::string name = "primitives/learn33.pcd";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    FitAtOptions options;
    options.kinds = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere};
    const auto at = [&](const Vec3d& place) { return fit_at(*cloud, {place}, {}, options); };
    const FittedPrimitive table = at({-0.1163, 0.0772, 0.9320});
    EXPECT_EQ(table.primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_EQ(table.primitive.fit.verdict, FitVerdict::good) << table.primitive.fit.message;
    EXPECT_GT(table.points.size(), 138000u);
    EXPECT_LT(table.points.size(), 143000u);
    const FittedPrimitive box = at({-0.1198, 0.1547, 0.7030});  // one of its faces, of 15,305 points in all
    EXPECT_EQ(box.primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_EQ(box.primitive.fit.verdict, FitVerdict::good) << box.primitive.fit.message;
    EXPECT_GT(box.points.size(), 10500u);
    EXPECT_LT(box.points.size(), 11500u);
    options.kinds = {ShapeKind::cylinder};
    // They stand on the table, and the camera smears their sides: whether they are certain is not.
    const FittedPrimitive can = at({0.1006, 0.1485, 0.7390}), other = at({0.2059, 0.0767, 0.8480});
    for (const ShapeFit& fit : {can.primitive.fit, other.primitive.fit}) {
        ASSERT_TRUE(fit.has_shape());
        EXPECT_EQ(fit.shape.kind, ShapeKind::cylinder);
        EXPECT_GT(std::fabs(dot(fit.shape.axis, table.primitive.fit.shape.axis)), 0.995);
    }
    EXPECT_NEAR(can.primitive.fit.shape.radius, other.primitive.fit.shape.radius, 0.0015);
}

Vec3d densest(const std::vector<Vec3d>& points)
{
    Vec3d best{};
    std::size_t most = 0;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 200) {
        std::size_t near = 0;
        for (const Vec3d& p : points) near += length(p - points[i]) < 0.05;
        if (near > most) best = points[i];
        most = std::max(most, near);
    }
    return best;
}

TEST_F(FitScan, PCM_NOT_UNDER_THREAD(SixFacesOfTheCube))
{
    const std::string name = "primitives/cube.pwn";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    // Its outer faces, and of each the one of some of the file's points on it that has the most of them around it.
    const Vec3d half{0.5, 0.371795, 0.371795};
    for (std::size_t a = 0; a < 3; ++a)
        for (const double side : {-1.0, 1.0}) {
            std::ifstream file(sample(name));
            std::vector<Vec3d> on_face;
            for (Vec3d p, n; file >> p[0] >> p[1] >> p[2] >> n[0] >> n[1] >> n[2];)
                if (std::fabs(p[a] - side * half[a]) < 1e-9) on_face.push_back(p);
            ASSERT_GT(on_face.size(), 500u);
            const FittedPrimitive face = fit(*cloud, ShapeKind::plane, densest(on_face));
            ASSERT_EQ(face.primitive.fit.verdict, FitVerdict::good) << face.primitive.fit.message;
            EXPECT_GT(std::fabs(face.primitive.fit.shape.axis[a]), 0.999999) << a << side;
            EXPECT_NEAR(face.primitive.fit.shape.point[a], side * half[a], 1e-6) << a << side;
        }
}

}  // namespace
