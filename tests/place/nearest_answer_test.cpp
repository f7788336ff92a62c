// The answer by the points next to the place alone.
#include "pcm/place/nearest_answer.h"

#include "pcm/place/fit_at.h"
#include "tests/place/station_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double nearest_noise = 0.001;
constexpr Vec3d knob_middle{456780, 5432100, 120};

pcm::Shape knob(double radius = 0.04)
{
    pcm::Shape shape;
    shape.kind = ShapeKind::sphere;
    shape.point = knob_middle;
    shape.radius = radius;
    return shape;
}

pcm::Shape plane_at(double x)
{
    pcm::Shape shape;
    shape.kind = ShapeKind::plane;
    shape.point = knob_middle + Vec3d{x, 0, 0};
    shape.axis = {1, 0, 0};
    return shape;
}

// Points on the knob's side of greater x, the nearest to its outermost point first.
std::vector<Vec3d> knob_points(std::size_t count, std::uint64_t seed)
{
    Dice dice(seed);
    std::vector<Vec3d> points;
    while (points.size() < count) {
        const Vec3d n = dice.direction();
        if (n[0] > 0.2) points.push_back(knob_middle + (0.04 + nearest_noise * dice.normal()) * n);
    }
    const Vec3d place = knob_middle + Vec3d{0.04, 0, 0};
    std::sort(points.begin(), points.end(),
              [&](const Vec3d& a, const Vec3d& b) { return length(a - place) < length(b - place); });
    return points;
}

// The sum over balls of 12, 24, 48, 96 points, point by point.
TEST(NearLikelihood, IsThatOfAMixtureOfTheShapeAndOfPointsAnywhere)
{
    const Vec3d place = knob_middle + Vec3d{0.04, 0, 0};
    const std::vector<Vec3d> points = knob_points(100, 5);
    const NearLikelihood likelihood(place, points, nearest_noise);
    for (const auto& [shape, numbers] : {std::pair(knob(), 4), std::pair(plane_at(0.03), 3)}) {
        double sum = 0;
        for (const int ball : {12, 24, 48, 96}) {
            const double radius = length(points[static_cast<std::size_t>(ball - 1)] - place);
            double ratio = 0;
            for (int i = 0; i < ball; ++i) {
                const double d = distance_to(shape, points[static_cast<std::size_t>(i)]);
                const double of_shape =
                    std::exp(-d * d / (2 * nearest_noise * nearest_noise)) / (nearest_noise * std::sqrt(2 * pi));
                const double anywhere = 1 / (2 * radius);
                ratio += std::log((of_shape / 2 + anywhere / 2) / (anywhere / 2));
            }
            sum += (ratio - numbers * std::log(ball) / 2) / ball;
        }
        EXPECT_NEAR(likelihood.of(shape), sum, 1e-9);
    }
    EXPECT_GT(likelihood.of(knob()), likelihood.of(plane_at(0.03)) + 1);
    EXPECT_GT(likelihood.of(knob()), likelihood.of(knob(0.043)) + 1);
}

// Fits whose answers are given, by the number of points; those that are followed have more points.
class NearestAnswerTest : public testing::Test {
protected:
    void SetUp() override
    {
        for (const Vec3d& p : knob_points(100, 6)) {
            near_.points.add(p);
            near_.ids.push_back({});
        }
        std::vector<SurfacePoint> points;
        for (const Vec3d& p : knob_points(300, 7)) points.push_back({p, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    FittedPrimitive answer(const pcm::Shape& shape, FitVerdict verdict, double share = 1) const
    {
        const double end = knob_middle[1] + 0.04 * (2 * share - 1);
        FittedPrimitive found{
            {}, set_where(tree_, [&](const Vec3d& p) { return p[1] < end; }), {}, {}, {}, 0, 0, false, 1, {}, {}, {},
            {}};
        found.primitive.fit.shape = shape;
        found.primitive.fit.verdict = verdict;
        found.primitive.fit.errors.radius = error_ * shape.radius;
        return found;
    }
    FittedPrimitive asked(FittedPrimitive found, double noise = nearest_noise)
    {
        asked_.clear();
        return or_nearest(std::move(found), knob_middle + Vec3d{0.04, 0, 0}, near_, noise,
                          [&](std::size_t count, bool grow) {
                              asked_.emplace_back(count, grow);
                              return grow ? answer(followed_, FitVerdict::good, share_)
                                          : answer(of_count_.at(count), FitVerdict::good, 0.5);
                          });
    }
    using Asked = std::vector<std::pair<std::size_t, bool>>;
    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    NearPoints near_;
    double error_ = 0.01, share_ = 1;
    std::map<std::size_t, pcm::Shape> of_count_{{16, plane_at(0.038)}, {40, knob(0.0405)}, {100, knob(0.0425)}};
    pcm::Shape followed_ = knob();
    Asked asked_;
    std::string message_;
    FittedPrimitive doubtful() const { return answer(plane_at(0.03), FitVerdict::doubtful); }
};

TEST_F(NearestAnswerTest, TheShapeThatExplainsTheNearestPointsBestIsFollowed)
{
    const FittedPrimitive found = asked(doubtful());
    EXPECT_EQ(asked_, (Asked{{16, false}, {40, false}, {100, false}, {40, true}}));
    EXPECT_EQ(found.primitive.fit.shape.radius, 0.04);
    EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::good);
    EXPECT_GT(found.points.size(), 250u);
    ASSERT_EQ(found.notes.size(), 1u);
    EXPECT_EQ(found.notes.front().find("the 40 points next to the place"), 0u);
}

TEST_F(NearestAnswerTest, AGoodAnswerAndOneWithoutKnownNoiseStay)
{
    EXPECT_EQ(asked(answer(plane_at(0.03), FitVerdict::good)).primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_TRUE(asked_.empty());
    EXPECT_EQ(asked(doubtful(), 0).primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_TRUE(asked_.empty());
    EXPECT_EQ(asked(answer({}, FitVerdict::refused)).primitive.fit.shape.kind, ShapeKind::sphere);
}

TEST_F(NearestAnswerTest, AnAnswerThatExplainsThemNearlyAsWellStays)
{
    const FittedPrimitive found = asked(answer(knob(0.0407), FitVerdict::doubtful));
    EXPECT_EQ(found.primitive.fit.shape.radius, 0.0407);
    EXPECT_EQ(asked_.size(), 3u);
}

TEST_F(NearestAnswerTest, ShapesOfUncertainSizeOrWithoutThePlaceDoNotCount)
{
    of_count_ = {{16, plane_at(0.02)}, {40, knob(0.0405)}, {100, plane_at(0.02)}};
    asked(doubtful());
    EXPECT_EQ(asked_.size(), 4u);
    error_ = 0.2;
    EXPECT_EQ(asked(doubtful()).primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_EQ(asked_.size(), 3u);
    error_ = 0.01;
    const NearPoints all = std::exchange(near_, {});
    near_.points.add(knob_middle + Vec3d{0.0455, 0, 0});
    for (const Vec3d& p : all.points.sources()) near_.points.add(p);
    near_.ids.resize(101);
    asked(doubtful());
    EXPECT_EQ(asked_.size(), 3u) << "the picked point is 5 noises off the knob";
}

// What it becomes where it is followed explains the nearest points worse, or has fewer points.
TEST_F(NearestAnswerTest, WhereItCannotBeFollowedItIsAnsweredAsDoubtful)
{
    followed_ = knob(0.046);
    FittedPrimitive found = asked(doubtful());
    EXPECT_EQ(found.primitive.fit.shape.radius, 0.0405);
    EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(found.primitive.fit.message.find("explains those next to the place worse"), std::string::npos);
    followed_ = knob();
    share_ = 0.3;
    found = asked(doubtful());
    EXPECT_EQ(found.primitive.fit.shape.radius, 0.0405);
    EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(found.notes.size(), 1u);
    share_ = 1;
    const std::vector<Vec3d> all = near_.points.sources();
    near_ = {};
    near_.points.add(knob_middle + Vec3d{0.0433, 0, 0});
    for (const Vec3d& p : all) near_.points.add(p);
    near_.ids.resize(101);
    EXPECT_EQ(asked(doubtful()).primitive.fit.shape.radius, 0.0405) << "followed, it is 3.3 noises off the point";
}

// The edge of two faces, seen from outside: a thin pipe along it explains the nearest points better than either face.
TEST_F(NearestAnswerTest, CurvedShapesAreComparedWithTheCornerOfTwoFaces)
{
    Dice dice(8);
    std::vector<Vec3d> points;
    for (int i = 0; i < 100; ++i) {
        const double along = dice.between(-0.06, 0.06), out = dice.between(0, 0.06),
                     off = nearest_noise * dice.normal();
        points.push_back(knob_middle + (i % 2 ? Vec3d{off, -out, along} : Vec3d{-out, off, along}));
    }
    std::sort(points.begin(), points.end(),
              [](const Vec3d& a, const Vec3d& b) { return length(a - knob_middle) < length(b - knob_middle); });
    Corner corner;
    corner.widest = plane_at(0);
    EXPECT_EQ(NearLikelihood(knob_middle, points, nearest_noise).of(corner),
              NearLikelihood(knob_middle, points, nearest_noise).of(plane_at(0)));
    corner.edge = plane_at(0);
    corner.edge->axis = {0, 1, 0};
    pcm::Shape pipe;
    pipe.kind = ShapeKind::cylinder;
    pipe.point = knob_middle - Vec3d{0.01, 0.01, 0};
    pipe.axis = {0, 0, 1};
    pipe.radius = 0.01;
    const NearLikelihood likelihood(knob_middle, points, nearest_noise);
    EXPECT_GT(likelihood.of(corner), likelihood.of(pipe) + 2);
    EXPECT_GT(likelihood.of(pipe), likelihood.of(plane_at(-0.01)) + 1);

    near_ = {};
    for (const Vec3d& p : points) near_.points.add(p);
    near_.ids.resize(100);
    for (auto& [count, shape] : of_count_) shape = pipe;
    error_ = 0.01;
    EXPECT_EQ(asked(answer(plane_at(-0.01), FitVerdict::doubtful)).primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_EQ(asked_.size(), 3u);
    for (auto& [count, shape] : of_count_) shape = plane_at(0);
    followed_ = plane_at(0);
    EXPECT_EQ(asked(answer(plane_at(-0.01), FitVerdict::doubtful)).primitive.fit.shape.point, knob_middle);
}

// The rim of a flange, 12 mm wide, is of a sphere as probably as of a cylinder, a knob of the sphere alone.
TEST_F(NearestAnswerTest, ABandIsOfACylinder)
{
    pcm::Shape ring;
    ring.kind = ShapeKind::cylinder;
    ring.point = knob_middle;
    ring.axis = {0, 0, 1};
    ring.radius = 0.1;
    const pcm::Shape ball = knob(0.1);
    const Vec3d place = knob_middle + Vec3d{0.1, 0, 0};
    const auto kind_on = [&](double width, const FittedPrimitive& found, FitVerdict of_ring) {
        Dice dice(9);
        std::vector<Vec3d> points;
        for (int i = 0; i < 100; ++i) {
            const double a = dice.between(-0.7, 0.7), z = dice.between(-width / 2, width / 2);
            const double r = std::sqrt(0.01 - z * z) + nearest_noise * dice.normal();
            points.push_back(knob_middle + Vec3d{r * std::cos(a), r * std::sin(a), z});
        }
        std::sort(points.begin(), points.end(),
                  [&](const Vec3d& a, const Vec3d& b) { return length(a - place) < length(b - place); });
        near_ = {};
        for (const Vec3d& p : points) near_.points.add(p);
        const FittedPrimitive band =
            or_band(found, place, near_, nearest_noise,
                    [&](const Vec3d& at, const std::vector<ShapeKind>& kinds, const std::optional<Clip>& part) {
                        EXPECT_EQ(at, place);
                        EXPECT_EQ(kinds, std::vector<ShapeKind>{ShapeKind::cylinder});
                        EXPECT_FALSE(part);
                        return answer(of_ring == FitVerdict::refused ? pcm::Shape{} : ring, of_ring);
                    });
        message_ = band.primitive.fit.message;
        if (band.primitive.fit.shape.kind == ShapeKind::cylinder) {
            EXPECT_EQ(band.primitive.fit.verdict, FitVerdict::doubtful);
        }
        return band.primitive.fit.shape.kind;
    };
    const FittedPrimitive sphere = answer(ball, FitVerdict::doubtful);
    EXPECT_EQ(kind_on(0.012, sphere, FitVerdict::good), ShapeKind::cylinder);
    EXPECT_NE(message_.find("a sphere of radius 0.1 explains"), std::string::npos) << message_;
    EXPECT_EQ(kind_on(0.08, sphere, FitVerdict::good), ShapeKind::sphere);
    EXPECT_EQ(kind_on(0.012, sphere, FitVerdict::refused), ShapeKind::sphere);
    EXPECT_EQ(kind_on(0.012, answer(ball, FitVerdict::good), FitVerdict::good), ShapeKind::sphere);
    EXPECT_EQ(kind_on(0.012, doubtful(), FitVerdict::good), ShapeKind::plane);
    pcm::Shape wider = knob(0.13);
    wider.point[0] -= 0.03;
    EXPECT_EQ(kind_on(0.012, answer(wider, FitVerdict::doubtful), FitVerdict::good), ShapeKind::sphere)
        << "that cylinder is another one";
}

// The rims of a pair of flanges of 200 mm, seen from one side: two bands of some 70 points, on a sphere, too.
TEST(NearestAnswer, PCM_NOT_UNDER_SANITIZERS(TheRimOfAFlangeIsAnsweredAsACylinder))
{
    int cylinders = 0;
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        Dice dice(seed);
        std::vector<SurfacePoint> points;
        const auto put = [&](double radius, double angle, double z, const Vec3d& n) {
            const Vec3d p = knob_middle + Vec3d{radius * std::cos(angle), radius * std::sin(angle), z};
            points.push_back({p + 0.0012 * dice.normal() * n, n});
        };
        const auto angle = [&] { return dice.between(-1.2, 1.2); };
        constexpr double density = 1 / (0.007 * 0.007);
        for (const double from : {0.0, 0.022})
            for (int i = 0; i < static_cast<int>(2.4 * 0.1 * 0.014 * density); ++i) {
                const double a = angle();
                put(0.1, a, from + dice.between(0, 0.014), {std::cos(a), std::sin(a), 0});
            }
        for (const double side : {-0.4, 0.036})
            for (int i = 0; i < static_cast<int>(2.4 * 0.06 * 0.4 * density); ++i) {
                const double a = angle();
                put(0.06, a, side + dice.between(0, 0.4), {std::cos(a), std::sin(a), 0});
            }
        for (const double z : {0.0, 0.036})
            for (int i = 0; i < static_cast<int>(0.1 * 1.2 * (0.01 - 0.0036) * density); ++i)
                put(std::sqrt(dice.between(0.0036, 0.01)), angle(), z, {0, 0, 1});
        TemporaryFolder folder;
        build_surface_tree(folder.path(), points);
        const auto cloud = PointCloud::open(folder / "surface.pct");
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        const double a = 0.2 * static_cast<double>(seed) - 0.7;
        const FittedPrimitive found =
            fit_at(*cloud, {knob_middle + Vec3d{0.1 * std::cos(a), 0.1 * std::sin(a), 0.007}}, {}, options);
        const ShapeFit& fit = found.primitive.fit;
        cylinders += fit.shape.kind == ShapeKind::cylinder && std::fabs(fit.shape.radius - 0.1) < 0.003;
    }
    EXPECT_GE(cylinders, 5) << "three, where the doubtful spheres stay";
}

// A knob of 80 mm on its stem, 70 mm before a plate, seen from one side: some 100 points next to as many others.
TEST(NearestAnswer, PCM_NOT_UNDER_SANITIZERS(AKnobBetweenOtherPartsIsAnsweredAsItsSphere))
{
    int within = 0;
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        Dice dice(seed);
        std::vector<SurfacePoint> points;
        const auto put = [&](const Vec3d& p, const Vec3d& n) {
            points.push_back({knob_middle + p + 0.0015 * dice.normal() * n, n});
        };
        constexpr double density = 1 / (0.009 * 0.009);
        for (int i = 0; i < static_cast<int>(2 * pi * 0.04 * 0.04 * density); ++i) {
            Vec3d n = dice.direction();
            n[0] = std::fabs(n[0]);
            put(0.04 * n, n);
        }
        for (int i = 0; i < static_cast<int>(pi * 0.015 * 0.3 * density); ++i) {
            const double a = dice.between(-pi / 2, pi / 2);
            const Vec3d n{std::cos(a), std::sin(a), 0};
            put(0.015 * n + Vec3d{0, 0, dice.between(-0.34, -0.037)}, n);
        }
        for (int i = 0; i < static_cast<int>(0.5 * 0.5 * density); ++i)
            put({-0.11, dice.between(-0.25, 0.25), dice.between(-0.35, 0.15)}, {1, 0, 0});
        for (int i = 0; i < static_cast<int>(0.1 * 0.3 * density); ++i)
            put({dice.between(-0.03, 0.05), dice.between(0.045, 0.05), dice.between(-0.2, 0.1)}, {0, -1, 0});
        TemporaryFolder folder;
        build_surface_tree(folder.path(), points);
        const auto cloud = PointCloud::open(folder / "surface.pct");
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        const Vec3d n = normalised(Vec3d{1, 0.1 * static_cast<double>(seed) - 0.4, 0.1});
        const FittedPrimitive found = fit_at(*cloud, {knob_middle + 0.04 * n}, {}, options);
        const ShapeFit& fit = found.primitive.fit;
        ASSERT_EQ(fit.shape.kind, ShapeKind::sphere) << seed;
        EXPECT_NEAR(fit.shape.radius, 0.04, 0.0015) << seed << ": " << fit.message;
        EXPECT_LT(fit.errors.radius, 0.004) << seed;
        within += std::fabs(fit.shape.radius - 0.04) < 3 * fit.errors.radius;
    }
    EXPECT_EQ(within, 6);
}

// Where three stations see the faces of a post, places on its edge are not good.
TEST(NearestAnswer, PCM_NOT_UNDER_SANITIZERS(PlacesOnAnEdgeSeenFromSeveralStationsAreDoubted))
{
    for (const std::uint64_t seed : {1, 2, 3}) {
        Dice dice(seed);
        std::vector<StationPoint> points;
        constexpr double half = 0.075, noise = 0.0013;
        for (const int side : {-1, 1})
            for (int i = 0; i < 6000; ++i) {
                const Vec3d out{side * half + noise * dice.normal(), dice.between(-half, half),
                                dice.between(-0.5, 0.5)};
                points.push_back({knob_middle + (i % 2 ? out : Vec3d{out[1], out[0], out[2]}), i / 2 % 3});
            }
        TemporaryFolder folder;
        build_station_tree(folder.path(), points, Says::source_id);
        const auto cloud = PointCloud::open(folder / "stations.pct");
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        const ShapeFit at_edge = fit_at(*cloud, {knob_middle + Vec3d{0.0747, 0.0746, 0.1}}, {}, options).primitive.fit;
        EXPECT_NE(at_edge.verdict, FitVerdict::good) << at_edge.message;
    }
}

// Levels of a depth camera, all of whose points have one depth, in clouds without and with stations, and a strip of
// terrain.
TEST(NearestAnswer, PCM_NOT_UNDER_SANITIZERS(PiecesOfRealSurfacesAreNotGood))
{
    const std::vector<std::tuple<const char*, Vec3d, const char*>> places{
        {"pcd/office1.pcd", {1.12713096, 0.6186972, 3.21600008}, "found by the points next to the place alone"},
        {"pcd/samp11-utm-ground.pcd", {512753.5625, 5403588, 314.79999}, "nearly all of its few points lie next to"},
        {"derived/kinect_2block_rgb.ptx", {1.098118, 0.9008, 2.252}, "one level of a depth camera"}};
    for (const auto& [name, place, why] : places) {
        PCM_REQUIRE_SAMPLE(name);
        TemporaryFolder folder;
        build_tree({sample(name)}, folder / "cloud.pct", {});
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        const ShapeFit fit = fit_at(*PointCloud::open(folder / "cloud.pct"), {place}, {}, options).primitive.fit;
        EXPECT_EQ(fit.verdict, FitVerdict::doubtful) << name;
        EXPECT_NE(fit.message.find(why), std::string::npos) << name << ": " << fit.message;
    }
}

}  // namespace
