// Several surfaces within one threshold: faces of posts and plates, pipes side by side, crowns of trees.

#include "pcm/place/one_surface.h"

#include "pcm/place/fit_at.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.0015;
constexpr Vec3d map{432107.25, 5413288.5, 214.75};

pcm::Shape level()
{
    pcm::Shape plane;
    plane.point = map;
    plane.axis = {0, 0, 1};
    return plane;
}

// At heights of a function over a square of one metre.
template <class Height>
std::vector<Vec3d> points_at(int count, Height height)
{
    Dice dice(3);
    std::vector<Vec3d> points;
    for (int i = 0; i < count; ++i) {
        const double x = dice.between(-0.5, 0.5), y = dice.between(-0.5, 0.5);
        points.push_back(map + Vec3d{x, y, height(x, y, dice)});
    }
    return points;
}

TEST(SurfaceEvidenceOf, NoiseHasOnePeakAndNoSlope)
{
    const auto flat = points_at(4000, [](double, double, Dice& dice) { return sigma * dice.normal(); });
    const SurfaceEvidence evidence = surface_evidence(level(), 4 * sigma, 0, flat);
    EXPECT_GT(evidence.points, 3990u);
    EXPECT_NEAR(evidence.two_peaks, 1.0 / 3, 0.03);
    EXPECT_NEAR(evidence.bend, 1.0 / 17, 0.02);
    EXPECT_LT(evidence.slope, 0.02);
    EXPECT_TRUE(evidence.is_one_surface());
    EXPECT_EQ(evidence.message(), "");
    // Thick relative to the spacing of points: neighbours are those along the shape.
    const auto thick = points_at(4000, [](double, double, Dice& dice) { return 0.05 * dice.normal(); });
    EXPECT_LT(surface_evidence(level(), 0.2, 0, thick).bend, 0.1);
    EXPECT_TRUE(surface_evidence(level(), 0.2, 0, thick).is_one_surface());
}

// Neighbours at the edge lie to one side of their point.
TEST(SurfaceEvidenceOf, AnInclinedPlaneHasItsSlope)
{
    for (const Vec2d& rise : {Vec2d{0.3, -0.4}, Vec2d{0, 0.5}, Vec2d{0.02, 0.01}}) {
        const auto plane = points_at(500, [&](double x, double y, Dice&) { return rise[0] * x + rise[1] * y; });
        const SurfaceEvidence evidence = surface_evidence(level(), 100, 0, plane);
        EXPECT_EQ(evidence.points, 500u);
        EXPECT_NEAR(evidence.slope / std::hypot(rise[0], rise[1]), 1, 1e-6);
        EXPECT_GT(evidence.bend, 0.8);
    }
}

TEST(SurfaceEvidenceOf, TwoFacesHaveTwoPeaks)
{
    for (const double share : {0.5, 0.2, 0.1}) {
        const auto plate = points_at(2000, [&](double, double, Dice& dice) {
            return (dice.unit() < share ? 0.008 : 0) - 0.008 * share + sigma * dice.normal();
        });
        const SurfaceEvidence evidence = surface_evidence(level(), 0.02, 0, plate);
        EXPECT_GT(evidence.two_peaks, 0.6) << share;
        EXPECT_TRUE(evidence.has_two_peaks()) << share;
        EXPECT_FALSE(evidence.message().empty());
        // Coordinates that are rounded to the distance of the faces say nothing.
        EXPECT_TRUE(surface_evidence(level(), 0.02, 0.008, plate).is_one_surface()) << share;
        // Nor do few points.
        const std::vector<Vec3d> few(plate.begin(), plate.begin() + 16);
        EXPECT_TRUE(surface_evidence(level(), 0.02, 0, few).is_one_surface());
    }
    const auto even = points_at(2000, [](double, double, Dice& dice) { return dice.between(-0.01, 0.01); });
    EXPECT_NEAR(surface_evidence(level(), 0.01, 0, even).two_peaks, 5.0 / 9, 0.02);
    EXPECT_TRUE(surface_evidence(level(), 0.01, 0, even).has_two_peaks());
}

TEST(SurfaceEvidenceOf, CrownsAreTurnedAndErrorsOfAScannerAreNot)
{
    const auto waves = [](double height, double length) {
        return points_at(4000, [=](double x, double y, Dice& dice) {
            return height * std::sin(2 * pi * x / length) * std::cos(2 * pi * y / length) + sigma * dice.normal();
        });
    };
    const SurfaceEvidence crowns = surface_evidence(level(), 1, 0, waves(0.1, 0.3));
    EXPECT_TRUE(crowns.is_turned()) << crowns.bend << " " << crowns.slope;
    const SurfaceEvidence scanner = surface_evidence(level(), 1, 0, waves(0.01, 0.3));
    EXPECT_TRUE(scanner.has_shared_errors()) << scanner.bend;
    EXPECT_TRUE(scanner.is_one_surface()) << scanner.slope;
}

TEST(SurfaceEvidenceOf, SpreadAndPlacesFollowTheNoise)
{
    ShapeFit fit;
    fit.threshold = 1;
    EXPECT_EQ(spread_of(fit), 1);
    EXPECT_NEAR(farthest_place(fit), 1.2, 1e-12);
    fit.noise = 0.2;
    EXPECT_NEAR(spread_of(fit), 0.66, 1e-12);
    EXPECT_NEAR(farthest_place(fit), 0.792, 1e-12);
    fit.noise = 0.001;
    EXPECT_NEAR(farthest_place(fit), 0.36, 1e-12);
}

class SeveralSurfaces : public testing::Test {
protected:
    void add(const Vec3d& p) { points_.push_back({map + p, {0, 0, 1}}); }
    // A rectangle from a corner.
    void add(int count, const Vec3d& corner, const Vec3d& u, const Vec3d& v)
    {
        const Vec3d normal = normalised(cross(u, v));
        for (int i = 0; i < count; ++i)
            add(corner + dice_.unit() * u + dice_.unit() * v + sigma * dice_.normal() * normal);
    }
    // Clutter in a box about the origin.
    void add_clutter(int count, const Vec3d& half)
    {
        for (int i = 0; i < count; ++i)
            add({dice_.between(-half[0], half[0]), dice_.between(-half[1], half[1]), dice_.between(-half[2], half[2])});
    }
    // The shape at a scanned point next to the place, whatever its kind.
    ShapeFit at(const Vec3d& place)
    {
        if (!cloud_) {
            build_surface_tree(folder_.path(), points_);
            cloud_ = PointCloud::open(folder_ / "surface.pct");
        }
        const SurfacePoint& nearest =
            *std::min_element(points_.begin(), points_.end(), [&](const SurfacePoint& a, const SurfacePoint& b) {
                return length(a.position - map - place) < length(b.position - map - place);
            });
        place_ = nearest.position;
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        return fit_at(*cloud_, {place_}, {}, options).primitive.fit;
    }

    Dice dice_{5};
    std::vector<SurfacePoint> points_;
    Vec3d place_{};  // the last one
    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
};

// Before, each of these places was a "cylinder: good" through the four faces, of four times the scanner's noise.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(SeveralSurfaces, PCM_NOT_UNDER_SANITIZERS(ASquarePostIsNoCylinder))
{
    const double half = 0.04;
    for (const int side : {-1, 1}) {
        add(1800, {side * half, -half, -0.75}, {0, 2 * half, 0}, {0, 0, 1.5});
        add(1800, {-half, side * half, -0.75}, {2 * half, 0, 0}, {0, 0, 1.5});
    }
    add_clutter(400, {0.1, 0.1, 0.8});
    int faces = 0;
    for (int i = 0; i < 6; ++i) {
        const ShapeFit fit = at({half, -0.024 + 0.0095 * i, -0.4 + 0.17 * i});
        if (fit.verdict != FitVerdict::good) continue;
        ASSERT_EQ(fit.shape.kind, ShapeKind::plane) << i << ": " << text_of(fit.shape) << ", noise " << fit.noise;
        EXPECT_GT(std::fabs(fit.shape.axis[0]), 0.999) << i;
        ++faces;
    }
    EXPECT_GE(faces, 4);
}

// Before, planes between the faces, 4 mm from each.
TEST_F(SeveralSurfaces, PCM_NOT_UNDER_THREAD(AThinPlateIsNotAPlaneBetweenItsFaces))
{
    for (const double height : {-0.004, 0.004}) add(9000, {-0.3, -0.3, height}, {0.6, 0, 0}, {0, 0.6, 0});
    for (int i = 0; i < 6; ++i) {
        const ShapeFit fit = at({-0.2 + 0.08 * i, 0.03 * i, i % 2 ? 0.004 : -0.004});
        if (fit.verdict != FitVerdict::good) continue;
        EXPECT_EQ(fit.shape.kind, ShapeKind::plane);
        EXPECT_LT(distance_to(fit.shape, place_), 4 * sigma) << i;
        const double height = signed_distance(level(), place_ - (signed_distance(fit.shape, place_) * fit.shape.axis));
        EXPECT_NEAR(std::fabs(height), 0.004, 0.0007) << i << ", noise " << fit.noise;
    }
}

// Before, planes over the crowns of several pipes.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(SeveralSurfaces, PCM_NOT_UNDER_SANITIZERS(PipesSideBySideAreNoPlane))
{
    std::vector<pcm::Shape> pipes;
    double y = 0;
    for (int k = 0; k < 8; ++k) {
        pcm::Shape pipe;
        pipe.kind = ShapeKind::cylinder;
        pipe.radius = 0.01 + 0.0015 * k;
        y += pipe.radius;
        pipe.point = map + Vec3d{0, y, 0};
        y += pipe.radius + 0.012;
        pipe.axis = {1, 0, 0};
        pipes.push_back(pipe);
        for (int i = 0; i < 4000; ++i) points_.push_back(point_on(pipe, 1.2, 1.3 * pi, sigma, dice_));
    }
    int found = 0, asked = 0;
    for (const pcm::Shape& pipe : pipes) {
        const SurfacePoint on_pipe = point_on(pipe, 1, 1.2 * pi, 0, dice_);
        const ShapeFit fit = at(on_pipe.position - map);
        ++asked;
        if (fit.verdict != FitVerdict::good) continue;
        ASSERT_EQ(fit.shape.kind, ShapeKind::cylinder)
            << asked << ": " << text_of(fit.shape) << ", noise " << fit.noise;
        EXPECT_NEAR(fit.shape.radius, pipe.radius, 0.001) << asked;
        ++found;
    }
    EXPECT_GE(found, asked / 2);
}

// Before, the canopy about a roof was a plane, of a noise of a third of its height.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(SeveralSurfaces, PCM_NOT_UNDER_SANITIZERS(ACanopyIsNoPlane))
{
    for (double x = -1.1; x < 1.1; x += 0.02)
        for (double y = -1.1; y < 1.1; y += 0.02) {
            const double px = x + dice_.between(-0.008, 0.008), py = y + dice_.between(-0.008, 0.008);
            const bool on_roof = std::fabs(px) < 0.12 && std::fabs(py) < 0.09;
            const double crowns = 0.1 * std::sin(22 * px) * std::cos(19 * py) + 0.06 * std::sin(9 * px + 14 * py) -
                                  0.03 * std::fabs(dice_.normal());
            add({px, py, 0.2 * px + (on_roof ? sigma * dice_.normal() : crowns)});
        }
    const Vec3d up = normalised({-0.2, 0, 1});
    for (int i = 0; i < 4; ++i) {
        const ShapeFit fit = at({-0.7 + 0.3 * i, 0.5 - 0.35 * i, 0});
        EXPECT_NE(fit.verdict, FitVerdict::good) << i << ": " << text_of(fit.shape) << ", noise " << fit.noise;
    }
    const ShapeFit roof = at({0.03, 0.02, 0.006});
    ASSERT_TRUE(roof.has_shape());
    EXPECT_TRUE(roof.verdict != FitVerdict::good ||
                (roof.shape.kind == ShapeKind::plane && std::fabs(dot(roof.shape.axis, up)) > 0.999));
}

}  // namespace
