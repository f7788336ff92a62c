// Clicks next to the edges of plates and posts.
#include "pcm/place/other_answers.h"

#include "pcm/place/fit_at.h"
#include "pcm/place/point_off.h"
#include "pcm/place/thin_pipe.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <cmath>
#include <memory>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double edge_noise = 0.0013;
constexpr Vec3d edge_middle{456780, 5432100, 120};

// A box about the middle: points on its four faces along z, 5 mm apart on average.
std::vector<SurfacePoint> box_along_z(double x, double y, double z, Dice& dice)
{
    constexpr double density = 1 / (0.005 * 0.005);
    std::vector<SurfacePoint> points;
    for (const int side : {-1, 1}) {
        for (int i = 0; i < static_cast<int>(y * z * density); ++i)
            points.push_back({edge_middle + Vec3d{side * x / 2 + edge_noise * dice.normal(),
                                                  dice.between(-y / 2, y / 2), dice.between(-z / 2, z / 2)},
                              {}});
        for (int i = 0; i < static_cast<int>(x * z * density); ++i)
            points.push_back(
                {edge_middle + Vec3d{dice.between(-x / 2, x / 2), side * y / 2 + edge_noise * dice.normal(),
                                     dice.between(-z / 2, z / 2)},
                 {}});
    }
    return points;
}

class OtherAnswersTest : public testing::Test {
protected:
    ShapeFit answer(const std::vector<SurfacePoint>& points, const Vec3d& offset)
    {
        build_surface_tree(folder_.path(), points);
        const auto cloud = PointCloud::open(folder_ / "surface.pct");
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        const FittedPrimitive found = fit_at(*cloud, {edge_middle + offset}, {}, options);
        count_ = found.points.size();
        return found.primitive.fit;
    }
    TemporaryFolder folder_;
    std::uint64_t count_ = 0;  // number of points of the answer
};

// The edge of a plate of 10 mm, 1.6 m long, is no wider than points of the faces next to it may move it.
TEST_F(OtherAnswersTest, PCM_NOT_UNDER_SANITIZERS(TheNarrowEdgeOfAPlateIsAnsweredAndDoubted))
{
    for (const std::uint64_t seed : {1, 2, 3}) {
        Dice dice(seed);
        const ShapeFit fit = answer(box_along_z(0.4, 0.01, 1.6, dice), {0.2, 0, 0.1});
        EXPECT_EQ(fit.verdict, FitVerdict::doubtful);
        ASSERT_EQ(fit.shape.kind, ShapeKind::plane) << fit.message;
        EXPECT_LT(std::fabs(dot(fit.shape.axis, Vec3d{0, 1, 0})), 0.2);
        EXPECT_GT(count_, 400u);
        EXPECT_LT(count_, 850u) << "of 640, without those of the faces next to it";
        EXPECT_LT(std::fabs(dot(fit.shape.axis, edge_middle + Vec3d{0.2, 0, 0} - fit.shape.point)), edge_noise);
    }
}

// Half a standard deviation from an edge of a post, no plane is good; 20 mm away all are.
TEST_F(OtherAnswersTest, PCM_NOT_UNDER_SANITIZERS(PlacesOnAnEdgeAreDoubted))
{
    for (const std::uint64_t seed : {1, 2, 3}) {
        Dice dice(seed);
        const std::vector<SurfacePoint> points = box_along_z(0.15, 0.15, 1, dice);
        const ShapeFit at_edge = answer(points, {0.0747, 0.0746, 0.1});
        EXPECT_NE(at_edge.verdict, FitVerdict::good) << at_edge.message;
        const ShapeFit on_face = answer(points, {0.055, 0.075, 0.1});
        EXPECT_EQ(on_face.verdict, FitVerdict::good) << on_face.message;
        EXPECT_EQ(on_face.shape.kind, ShapeKind::plane);
    }
}

// Four standard deviations from the edge of a post, the face at the place.
TEST_F(OtherAnswersTest, PCM_NOT_UNDER_SANITIZERS(AFaceNextToAnEdgeIsAnswered))
{
    for (const std::uint64_t seed : {1, 2, 3}) {
        Dice dice(seed);
        const std::vector<SurfacePoint> points = box_along_z(0.15, 0.15, 1, dice);
        const ShapeFit of_y = answer(points, {0.070, 0.075, 0.1}), of_x = answer(points, {0.075, 0.070, 0.1});
        for (const ShapeFit* fit : {&of_y, &of_x}) {
            EXPECT_EQ(fit->verdict, FitVerdict::good) << fit->message;
            EXPECT_GT(std::fabs(dot(fit->shape.axis, fit == &of_y ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0})), 0.9999);
        }
    }
}

// What was found, followed or not: the shape, good.
FittedPrimitive good_answer(const std::shared_ptr<const Tree>& tree, const ShapeFit& fit)
{
    FittedPrimitive found{{}, PointSet(tree), {}, {}, fit, 0, 0, false, 1, {}, {}, {}, {}};
    found.primitive.fit = fit;
    found.primitive.fit.verdict = FitVerdict::good;
    return found;
}

// Where points are as far apart as a thin pipe is wide, the edge of a post is one within the threshold. 6 mm from it
// the two faces are found.
TEST_F(OtherAnswersTest, PCM_NOT_UNDER_SANITIZERS(TheEdgeOfAPostIsNoThinPipe))
{
    constexpr double half = 0.1;
    Dice dice(4);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 800; ++i)
        for (const bool is_x : {false, true}) {
            const double along = dice.between(-half, half), away = half + edge_noise * dice.normal();
            const Vec3d p{is_x ? away : along, is_x ? along : away, dice.between(-0.6, 0.6)};
            points.push_back({edge_middle + p, {}});
        }
    const auto tree = build_surface_tree(folder_.path(), points);
    const auto cloud = PointCloud::open(folder_ / "surface.pct");
    const FollowShape follow = [&](const LocalFit& local, const std::optional<Clip>&) {
        return good_answer(tree, local.fit);
    };
    FittedPrimitive doubtful = good_answer(tree, {});
    doubtful.primitive.fit.verdict = FitVerdict::doubtful;
    const Vec3d place = edge_middle + Vec3d{half - 0.006, half, 0.1};
    ASSERT_TRUE(fit_thin_pipe(*cloud, place, any_kind(), infinity));
    const OtherAnswers answers(*cloud, place, any_kind(), 0, follow);
    EXPECT_EQ(answers.best(doubtful).primitive.fit.shape.kind, ShapeKind::plane);
}

// A pipe and the disc that closes it. Points of the disc are off the pipe, one near the border by little; one of the
// pipe is off it by chance.
TEST_F(OtherAnswersTest, APointOffTheShapeIsDoubted)
{
    Dice dice(2);
    ShapeFit pipe;
    pipe.shape.kind = ShapeKind::cylinder;
    pipe.shape.point = edge_middle;
    pipe.shape.axis = {0, 0, 1};
    pipe.shape.radius = 0.3;
    pipe.noise = edge_noise;
    pipe.threshold = 3 * edge_noise;
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 20000; ++i) points.push_back(point_on(pipe.shape, 1, pi, 0.3 * edge_noise, dice));
    for (int i = 0; i < 6000; ++i) {
        const double a = dice.between(0, pi), r = 0.3 * std::sqrt(dice.unit());
        points.push_back({edge_middle + Vec3d{r * std::cos(a), r * std::sin(a), 0}, {}});
    }
    const auto [u, v] = across(pipe.shape.axis);
    const Vec3d out = std::cos(1.0) * u + std::sin(1.0) * v;
    const auto at = [&](double away, double along) { return edge_middle + (0.3 + away) * out + Vec3d{0, 0, along}; };
    const std::vector<Vec3d> places{at(0, 0.5), at(2 * edge_noise, 0.52), at(2.7 * edge_noise, 0.54),
                                    at(-1.5 * edge_noise, 0), at(-0.8 * edge_noise, 0.0001)};
    for (const Vec3d& place : places) points.push_back({place, {}});
    const auto tree = build_surface_tree(folder_.path(), points);
    const auto cloud = PointCloud::open(folder_ / "surface.pct");
    const auto verdict = [&](const Vec3d& place) {
        FittedPrimitive found = good_answer(tree, pipe);
        doubt_point_off(*cloud, place, {}, found);
        return found.primitive.fit.verdict;
    };
    const std::vector<bool> is_good{true, true, true, false, true};
    for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(verdict(places[i]) == FitVerdict::good, is_good[i]) << i;
    EXPECT_EQ(verdict(at(0.01, 0.7)), FitVerdict::good) << "typed, between points of the shape";
}

// The edge of a step: points below a plane are beyond its threshold, one next to it is not, and one alone is noise.
TEST_F(OtherAnswersTest, APointBeyondThePlaneIsDoubted)
{
    Dice dice(3);
    ShapeFit plane;
    plane.shape.point = edge_middle;
    plane.shape.axis = {0, 0, 1};
    plane.noise = edge_noise;
    plane.threshold = 3 * edge_noise;
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 6000; ++i) {
        const double x = dice.between(-0.3, 0.3);
        const double z = x < 0 ? -0.008 : 0.3 * edge_noise * dice.normal();
        points.push_back({edge_middle + Vec3d{x, dice.between(-0.2, 0.2), z}, {}});
    }
    const std::vector<Vec3d> places{{0.1, 0, -2.8 * edge_noise}, {0.1, 0.1, -0.008}, {-0.1, 0, -0.008}};
    for (const Vec3d& place : places) points.push_back({edge_middle + place, {}});
    const auto tree = build_surface_tree(folder_.path(), points);
    const auto cloud = PointCloud::open(folder_ / "surface.pct");
    const std::vector<bool> is_good{true, true, false};
    for (std::size_t i = 0; i < places.size(); ++i) {
        FittedPrimitive found = good_answer(tree, plane);
        doubt_point_aside(*cloud, edge_middle + places[i], {}, found);
        EXPECT_EQ(found.primitive.fit.verdict == FitVerdict::good, is_good[i]) << i;
    }
}

// A narrow face next to a plane, within its threshold: the point that was picked and two next to it are to one side by
// more than twice the noise.
TEST_F(OtherAnswersTest, APointAsideOfThePlaneIsDoubtedWithTwoNextToItOnItsSide)
{
    Dice dice(4);
    ShapeFit plane;
    plane.shape.point = edge_middle;
    plane.shape.axis = {0, 0, 1};
    plane.noise = edge_noise;
    plane.threshold = 3.3 * edge_noise;
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 6000; ++i)
        points.push_back(
            {edge_middle + Vec3d{dice.between(-0.3, 0.3), dice.between(-0.2, 0.2), 0.3 * edge_noise * dice.normal()},
             {}});
    struct Three {
        double picked, next, other;
        bool is_good;
    };
    const std::vector<Three> threes{{2.2, 2.1, 2.3, false}, {-2.2, -2.1, -2.3, false}, {2.2, 2.1, -2.3, true},
                                    {2.2, 1.9, 2.3, true},  {1.9, 2.2, 2.3, true},     {2.8, 2.8, 0, true}};
    std::vector<Vec3d> places;
    for (std::size_t i = 0; i < threes.size(); ++i) {
        const Vec3d middle = edge_middle + Vec3d{0.08 * static_cast<double>(i) - 0.2, 0, 0};
        places.push_back(middle + Vec3d{0, 0, threes[i].picked * edge_noise});
        points.push_back({places.back(), {}});
        points.push_back({middle + Vec3d{0.001, 0.001, threes[i].next * edge_noise}, {}});
        points.push_back({middle + Vec3d{0.001, -0.001, threes[i].other * edge_noise}, {}});
    }
    const auto tree = build_surface_tree(folder_.path(), points);
    const auto cloud = PointCloud::open(folder_ / "surface.pct");
    for (std::size_t i = 0; i < threes.size(); ++i) {
        FittedPrimitive found = good_answer(tree, plane);
        doubt_point_aside(*cloud, places[i], {}, found);
        EXPECT_EQ(found.primitive.fit.verdict == FitVerdict::good, threes[i].is_good) << i;
        // Where neighbours share errors, those next to it are off with it.
        found = good_answer(tree, plane);
        found.agreement = 2;
        doubt_point_aside(*cloud, places[i], {}, found);
        EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::good) << i;
    }
}

// Planes next to each other hold the points of a pipe, too.
TEST_F(OtherAnswersTest, PCM_NOT_UNDER_SANITIZERS(APipeStaysAPipe))
{
    Dice dice(7);
    pcm::Shape pipe;
    pipe.kind = ShapeKind::cylinder;
    pipe.point = edge_middle;
    pipe.axis = {0, 0, 1};
    pipe.radius = 0.03;
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 3000; ++i) points.push_back(point_on(pipe, 0.8, pi, edge_noise, dice));
    for (const int i : {0, 1, 2, 3}) {
        const ShapeFit fit = answer(points, points[static_cast<std::size_t>(i)].position - edge_middle);
        EXPECT_EQ(fit.shape.kind, ShapeKind::cylinder) << fit.message;
        EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
    }
}

}  // namespace
