// Neighbourhood and threshold of a fit at places, where several surfaces lie close together.

#include "pcm/place/local_fit.h"

#include "pcm/place/fit_at.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.002;

class LocalFitTest : public testing::Test {
protected:
    void add(std::size_t count, const Vec3d& corner, const Vec3d& u, const Vec3d& v)
    {
        const Vec3d normal = normalised(cross(u, v));
        for (std::size_t i = 0; i < count; ++i)
            points_.push_back({corner + dice_.unit() * u + dice_.unit() * v + sigma * dice_.normal() * normal, normal});
    }
    void add_point(const Vec3d& p) { points_.push_back({p, {0, 0, 1}}); }
    void build()
    {
        build_surface_tree(folder_.path(), points_);
        cloud_ = PointCloud::open(folder_ / "surface.pct");
    }
    // A step of 20 cm between two floors.
    void build_curb()
    {
        add(30000, {-5, -3, 0}, {10, 0, 0}, {0, 3, 0});
        add(30000, {-5, 0, 0.2}, {10, 0, 0}, {0, 3, 0});
        add(2000, {-5, 0, 0}, {10, 0, 0}, {0, 0, 0.2});
        build();
    }
    LocalFit fit(const Vec3d& place, std::size_t count = 0) const
    {
        LocalFitOptions options;
        options.count = count;
        return fit_locally(*cloud_, {place}, options);
    }
    static bool has_note(const std::vector<std::string>& notes, const std::string& part)
    {
        return std::any_of(notes.begin(), notes.end(),
                           [&](const std::string& note) { return note.find(part) != std::string::npos; });
    }

    Dice dice_{8};
    std::vector<SurfacePoint> points_;
    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
};

// Floor, step and floor together are within 10 cm of a plane, which is not the answer.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(LocalFitTest, PCM_NOT_UNDER_THREAD(AWiderThresholdTakesInNoOtherSurface))
{
    build_curb();
    for (int i = 0; i < 20; ++i) {
        const LocalFit found = fit({-4 + 0.4 * i, 0, 0.1}, 500);
        ASSERT_TRUE(found.fit.has_shape());
        EXPECT_LT(found.fit.threshold, 8 * sigma) << i;
        EXPECT_LT(found.fit.noise, 2 * sigma) << i;
    }
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(LocalFitTest, PCM_NOT_UNDER_THREAD(OnANarrowFaceItLooksCloser))
{
    build_curb();
    int of_the_face = 0;
    for (int i = 0; i < 20; ++i) {
        const LocalFit found = fit({-4 + 0.4 * i, 0, 0.1});
        if (found.fit.verdict != FitVerdict::good) continue;
        EXPECT_GT(std::fabs(found.fit.shape.axis[1]), 0.95) << i;
        of_the_face += has_note(found.notes, "narrowed");
    }
    EXPECT_GE(of_the_face, 12);
}

// A wider threshold is taken where it holds clearly more points, not where it holds a few of something else.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(LocalFitTest, PCM_NOT_UNDER_THREAD(TheThresholdStaysAtTheNoise))
{
    add(20000, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
    for (int i = 0; i < 2500; ++i) add_point({dice_.between(-2, 2), dice_.between(-2, 2), dice_.between(-0.5, 0.5)});
    build();
    for (int i = 0; i < 30; ++i) {
        const LocalFit found = fit({dice_.between(-1, 1), dice_.between(-1, 1), 0}, 500);
        const double automatic = automatic_threshold(found.close.points);
        EXPECT_LE(found.fit.threshold, 1.01 * automatic) << i;
    }
}

// Two walls cross where the place is: the denser one is found, and ends; the other one is wider.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(LocalFitTest, PCM_NOT_UNDER_THREAD(AWiderNeighbourhoodFollowsTheFormerSurface))
{
    add(1280, {0, -0.2, -0.2}, {0, 0.4, 0}, {0, 0, 0.4});
    add(24000, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    build();
    for (int i = -4; i <= 4; ++i) {
        const LocalFit found = fit({0, 0.02 * i, 0});
        ASSERT_EQ(found.fit.verdict, FitVerdict::good) << found.fit.message;
        EXPECT_GT(std::fabs(found.fit.shape.axis[0]), 0.99) << i;
    }
}

// The nearest surface does not pass through a point above it.
TEST_F(LocalFitTest, ASurfaceNextToThePlaceIsDoubtful)
{
    add(20000, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
    add_point({0, 0, 0.04});
    build();
    EXPECT_EQ(fit({0.5, 0.5, 0}).fit.verdict, FitVerdict::good);
    const LocalFit found = fit({0, 0, 0.04});
    EXPECT_EQ(found.fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(found.fit.issue, FitIssue::no_consensus);
}

// The floor's plane passes through the place, in a hole of the floor that something else fills.
TEST_F(LocalFitTest, ASurfaceThatIsNotAroundThePlaceIsDoubtful)
{
    for (int i = 0; i < 40000;) {
        const Vec3d p{dice_.between(-2, 2), dice_.between(-2, 2), sigma * dice_.normal()};
        if (std::hypot(p[0], p[1]) < 0.3) continue;
        add_point(p);
        ++i;
    }
    for (int i = 0; i < 60; ++i) add_point(0.1 * std::cbrt(dice_.unit()) * dice_.direction());
    add_point({0, 0, 0});
    build();
    const LocalFit found = fit({0, 0, 0});
    EXPECT_NE(found.fit.verdict, FitVerdict::good);
}

// A plane is asked for where the surface is bent: the larger it grows, the farther its points are from it.
// Not under the thread sanitizer: many fits, whose threads other tests watch.
TEST(FitAtGrown, PCM_NOT_UNDER_THREAD(NoiseFarAboveThatOfThePlaceIsDoubtful))
{
    TemporaryFolder folder;
    Dice dice(9);
    std::vector<SurfacePoint> points;
    pcm::Shape ball;
    ball.kind = ShapeKind::sphere;
    ball.radius = 30;
    for (int i = 0; i < 60000; ++i) {
        const double x = dice.between(-3, 3), y = dice.between(-3, 3);
        const Vec3d p = normalised({x, y, 30});
        points.push_back({(30 + sigma * dice.normal()) * p, p});
    }
    build_surface_tree(folder.path(), points);
    const auto cloud = PointCloud::open(folder / "surface.pct");
    FitAtOptions options;
    const FittedPrimitive found = fit_at(*cloud, {{0, 0, 30}}, {}, options);
    EXPECT_EQ(found.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_NE(found.primitive.fit.message.find("those around the place"), std::string::npos);
    EXPECT_TRUE(found.converged);
    for (const PlacedPoint& p : all_points(found.points.tree()))
        if (found.points.contains(p.node, p.number))
            ASSERT_LE(distance_to(found.primitive.fit.shape, p.position), found.primitive.fit.threshold);
    // A threshold that is given allows for it, unless it cuts a piece out of the surface.
    options.fit.threshold = 0.2;
    options.count = 500;
    const FittedPrimitive wide = fit_at(*cloud, {{0, 0, 30}}, {}, options);
    EXPECT_GT(wide.primitive.fit.noise, 3 * wide.local.noise);
    EXPECT_EQ(wide.primitive.fit.verdict, FitVerdict::good) << wide.primitive.fit.message;
    options.fit.threshold = 0.03;
    const FittedPrimitive piece = fit_at(*cloud, {{0, 0, 30}}, {}, options);
    EXPECT_EQ(piece.primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(piece.primitive.fit.issue, FitIssue::other_surface);
    options.fit.threshold = 0;
    options.count = 0;
    // A fit of the right kind is good.
    options.fit.kind = ShapeKind::sphere;
    const FittedPrimitive right = fit_at(*cloud, {{0, 0, 30}}, {}, options);
    EXPECT_EQ(right.primitive.fit.verdict, FitVerdict::good);
    EXPECT_GT(right.points.size(), 59000u);
}

// Where a flange has a web below, the closest points are those of three faces; the threshold is that of the flange's
// own noise all the same, so that the web's faces do not tilt it.
TEST_F(LocalFitTest, TheThresholdIsThatOfTheSurfaceWhereOthersMeetIt)
{
    add(6000, {-0.1, -1, 0}, {0.2, 0, 0}, {0, 2, 0});
    for (const double x : {-0.012, 0.012}) add(9000, {x, -1, -0.004}, {0, 2, 0}, {0, 0, -0.3});
    build();
    LocalFitOptions options;
    options.kinds = any_kind().kinds;
    for (const double y : {-0.3, 0.0, 0.3}) {
        const LocalFit local = fit_locally(*cloud_, {{0.02, y, 0}}, options);
        ASSERT_TRUE(local.fit.has_shape());
        ASSERT_EQ(local.fit.shape.kind, ShapeKind::plane);
        EXPECT_GT(std::fabs(local.fit.shape.axis[2]), 0.999);
        EXPECT_LT(local.fit.threshold, 4.5 * sigma) << y;
    }
}

}  // namespace
