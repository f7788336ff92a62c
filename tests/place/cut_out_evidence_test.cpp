// Shapes asked for where the cloud has another: rings and strips of it, or all of it within a wide threshold.

#include "pcm/place/cut_out_evidence.h"

#include "pcm/place/best_kind.h"
#include "pcm/place/fit_at.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.002;
constexpr Vec3d map{500123.4, 4800567.8, 100};

pcm::Shape shape_of(ShapeKind kind, double radius)
{
    Shape shape;
    shape.kind = kind;
    shape.point = map;
    shape.axis = normalised({0.2, -0.3, 0.9});
    shape.radius = radius;
    shape.second = kind == ShapeKind::torus ? 0.2 : 0.4;
    return shape;
}

std::vector<Vec3d> points_of(const Shape& shape, int count, double size, double arc, Dice& dice)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < count; ++i) points.push_back(point_on(shape, size, arc, sigma, dice).position);
    return points;
}

std::vector<Vec3d> near(const Shape& shape, double distance, const std::vector<Vec3d>& points)
{
    std::vector<Vec3d> some;
    for (const Vec3d& p : points)
        if (distance_to(shape, p) <= distance) some.push_back(p);
    return some;
}

TEST(CutOutEvidence, APipeOvershootsTheRingOfASphere)
{
    Dice dice(1);
    const std::vector<Vec3d> pipe = points_of(shape_of(ShapeKind::cylinder, 0.5), 20000, 2, 2 * pi, dice);
    Shape ball = shape_of(ShapeKind::sphere, 0.497);  // the ring is on both sides of it
    ball.point = map + 1.0 * shape_of(ShapeKind::cylinder, 0.5).axis;
    const double threshold = 0.008;
    const CutOutEvidence ring = cut_out_evidence(ball, threshold, near(ball, 4 * threshold, pipe));
    // Distances grow as squares of the way from the ring: half of the points to 4 thresholds are within one.
    EXPECT_GT(ring.overshoot, 0.3);
    EXPECT_LT(ring.overshoot, 1.5);
    EXPECT_GT(ring.bend, 0.5);
    EXPECT_TRUE(ring.is_cut_out(0));
    EXPECT_TRUE((CutOutEvidence{0.2, 0.1, 0}.is_cut_out(3)));
    EXPECT_FALSE((CutOutEvidence{0.2, 0.1, 0}.is_cut_out(1)));
    EXPECT_FALSE((CutOutEvidence{0.05, 0.5, 0}.is_cut_out(3)));
    const Shape truth = shape_of(ShapeKind::cylinder, 0.5);
    const CutOutEvidence itself = cut_out_evidence(truth, threshold, near(truth, 4 * threshold, pipe));
    EXPECT_EQ(itself.overshoot, 0);
    EXPECT_NEAR(itself.bend, 1.0 / 17, 0.01);
    EXPECT_LT(itself.chance, 0.001);
    EXPECT_FALSE(itself.is_cut_out(9));
}

// The oracle: from all pairs of few points, with 17 nearest neighbours, and the median way to the fifth of these.
CutOutEvidence by_all_pairs(double threshold, const std::vector<Vec3d>& points)
{
    std::vector<Vec3d> inside;
    for (const Vec3d& p : points)
        if (std::fabs(p[2]) <= threshold) inside.push_back(p);
    const auto nearest = [&](const Vec3d& p) {
        std::vector<std::pair<double, double>> found;  // square of the distance, and the point's height
        for (const Vec3d& q : inside) found.emplace_back(squared_distance(p, q), q[2]);
        std::sort(found.begin(), found.end());
        return found;
    };
    double squares = 0, smooth = 0;
    std::vector<double> ways;
    for (const Vec3d& p : inside) {
        const auto found = nearest(p);
        double sum = 0;
        for (std::size_t k = 0; k < 17; ++k) sum += found[k].second;
        squares += p[2] * p[2];
        smooth += std::pow(sum / 17, 2);
        ways.push_back(std::sqrt(found[4].first));
    }
    std::sort(ways.begin(), ways.end());
    double overshoot = 0;
    std::vector<double> bands(12);  // half a threshold each, above and below
    for (const Vec3d& p : points) {
        const double outside = std::fabs(p[2]) - threshold;
        if (outside <= 0 || outside > 3 * threshold) continue;
        bands[static_cast<std::size_t>(outside / threshold * 2) + (p[2] > 0 ? 6 : 0)] += 1;
        overshoot += std::sqrt(nearest(p)[0].first) > 1.2 * outside + 1.5 * ways[inside.size() / 2];
    }
    const auto count = double(inside.size());
    std::sort(bands.begin(), bands.end());
    return {overshoot / count, smooth / squares, 4 * bands[6] / count};
}

// Another face is in some of the distances next to a plane, points by chance are in all of them.
TEST(CutOutEvidence, TheOtherFaceOfAPlateIsNotThereByChance)
{
    const Shape plane{ShapeKind::plane, {0, 0, 0}, {0, 0, 1}, 0, 0};
    Dice dice(6);
    std::vector<Vec3d> plate, clutter;
    for (int i = 0; i < 2000; ++i) {
        plate.push_back({dice.between(0, 1), dice.between(0, 1), 0.001 * dice.normal()});
        plate.push_back({dice.between(0, 1), dice.between(0, 1), 0.008 + 0.001 * dice.normal()});
        clutter.push_back({dice.between(0, 1), dice.between(0, 1), dice.between(-0.012, 0.012)});
    }
    EXPECT_FALSE(cut_out_evidence(plane, 0.003, plate).is_by_chance());
    EXPECT_TRUE(cut_out_evidence(plane, 0.003, clutter).is_by_chance());
}

TEST(CutOutEvidence, EqualsThatOfAllPairs)
{
    const Shape plane{ShapeKind::plane, {0, 0, 0}, {0, 0, 1}, 0, 0};
    Dice dice(5);
    std::size_t some = 0;
    for (int round = 0; round < 40; ++round) {
        const double threshold = 0.1;
        std::vector<Vec3d> points;
        const int count = 17 + round;
        for (int i = 0; i < count; ++i)
            points.push_back({dice.between(-1, 1), dice.between(-1, 1), dice.between(-threshold, threshold)});
        for (int i = 0; i < 20; ++i)  // next to them, and farther
            points.push_back({dice.between(-1, 4), dice.between(-1, 1), dice.between(1.01, 4.5) * threshold});
        const CutOutEvidence found = cut_out_evidence(plane, threshold, points),
                             wanted = by_all_pairs(threshold, points);
        EXPECT_NEAR(found.overshoot, wanted.overshoot, 1e-12) << round;
        EXPECT_NEAR(found.bend, wanted.bend, 1e-9) << round;
        EXPECT_NEAR(found.chance, wanted.chance, 1e-12) << round;
        some += wanted.overshoot > 0 && wanted.chance > 0;
    }
    EXPECT_GT(some, 30u);
    // Fewer than 17 points give no evidence.
    const CutOutEvidence none = cut_out_evidence(plane, 1, std::vector<Vec3d>(16, Vec3d{0, 0, 0.5}));
    EXPECT_EQ(none.bend, 0);
    EXPECT_EQ(none.overshoot, 0);
}

// A face of a box, twenty thresholds wide: walls stand on it, and clutter hangs over it.
TEST(CutOutEvidence, WallsAndClutterAreNotOvershoot)
{
    Dice dice(2);
    const double threshold = 0.006, half = 0.06;
    Shape face;
    face.axis = {0, 0, 1};
    std::vector<Vec3d> points;
    for (int i = 0; i < 4000; ++i) {
        const double u = dice.between(-half, half), v = dice.between(-half, half), e = sigma * dice.normal();
        points.push_back({u, v, e});
        const double w = dice.between(-2 * half, 0);
        for (const double side : {-1.0, 1.0}) {
            points.push_back({side * half + e, v, w});
            points.push_back({u, side * half + e, w});
        }
        if (i % 20 == 0) points.push_back({u, v, dice.between(0, 4 * threshold)});
    }
    const CutOutEvidence around = cut_out_evidence(face, threshold, near(face, 4 * threshold, points));
    EXPECT_LT(around.overshoot, 0.05);
    EXPECT_FALSE(around.is_cut_out(1));
    EXPECT_FALSE(around.is_by_chance());
}

TEST(CutOutEvidence, PointsEverywhereAreThereByChance)
{
    Dice dice(3);
    const Shape ball = shape_of(ShapeKind::sphere, 0.5);
    std::vector<Vec3d> points;
    for (int i = 0; i < 200000; ++i)
        points.push_back(map + Vec3d{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)});
    const CutOutEvidence by_chance = cut_out_evidence(ball, 0.02, near(ball, 0.08, points));
    EXPECT_NEAR(by_chance.chance, 1, 0.1);
    EXPECT_TRUE(by_chance.is_by_chance());
    EXPECT_FALSE(by_chance.is_cut_out(1));
    // With a threshold of one standard deviation a third of the points are off the shape, and are its own.
    const std::vector<Vec3d> own = points_of(ball, 20000, 1, pi, dice);
    EXPECT_LT(cut_out_evidence(ball, sigma, own).chance, 0.1);
    EXPECT_EQ(cut_out_evidence(ball, sigma, {}).chance, 0);
    EXPECT_EQ(cut_out_evidence(ball, sigma, {map, map}).bend, 0);
}

TEST(BetterKind, IsOneThatLeavesMuchLessNoise)
{
    Dice dice(4);
    const Shape pipe = shape_of(ShapeKind::cylinder, 0.1);
    const std::vector<Vec3d> points = points_of(pipe, 5000, 2, pi, dice);
    ShapeFit plane;
    plane.verdict = FitVerdict::good;
    plane.shape = shape_of(ShapeKind::plane, 0);
    const auto [u, v] = across(pipe.axis);
    plane.shape.axis = v;
    plane.shape.point = map + 0.06 * v;
    plane.threshold = 0.08;
    plane.noise = 0.03;
    EXPECT_EQ(better_kind(plane, points, sigma), ShapeKind::cylinder);
    plane.noise = 3 * sigma;  // three tenths of it are less than the pipe's own noise, but nothing else is left
    EXPECT_EQ(better_kind(plane, points, sigma), ShapeKind::cylinder);
    plane.noise = 2 * sigma;  // the pipe's own noise is half of it
    EXPECT_FALSE(better_kind(plane, points, sigma));
    plane.noise = 0.03;
    // A third of the points are the pipe's.
    std::vector<Vec3d> more = points;
    for (int i = 0; i < 10000; ++i)
        more.push_back(plane.shape.point + dice.between(-1, 1) * u + dice.between(-0.08, 0.08) * v +
                       dice.between(0, 2) * pipe.axis);
    EXPECT_FALSE(better_kind(plane, more, sigma));
    ShapeFit cylinder;
    cylinder.shape = pipe;
    cylinder.threshold = 4 * sigma;
    cylinder.noise = 4 * sigma;
    EXPECT_FALSE(better_kind(cylinder, points, sigma));
    EXPECT_FALSE(better_kind(plane, {}, sigma));
    // As a camera bends a ceiling.
    Shape bent = shape_of(ShapeKind::cylinder, 60);
    bent.point = map - 60 * across(bent.axis)[0];
    plane.shape.axis = across(bent.axis)[0];
    plane.shape.point = map;
    plane.threshold = 0.1;
    plane.noise = 0.03;
    EXPECT_FALSE(better_kind(plane, points_of(bent, 5000, 5, 0.05, dice), sigma));
}

struct Asked {
    const char* what;
    ShapeKind there, asked;
    double radius, threshold;  // 0: automatic
};

class AskedOnAnother : public testing::TestWithParam<Asked> {};

// Neither the shape nor its points are what the cloud has: the verdict reports it, or there is no shape.
// Not under the thread sanitizer: many fits, whose threads other tests watch.
TEST_P(AskedOnAnother, PCM_NOT_UNDER_THREAD(IsNotCalledGood))
{
    const Asked& row = GetParam();
    TemporaryFolder folder;
    Dice dice(7);
    const Shape truth = shape_of(row.there, row.radius);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 12000; ++i) points.push_back(point_on(truth, 2, pi, sigma, dice));
    build_surface_tree(folder.path(), points);
    const auto cloud = PointCloud::open(folder / "surface.pct");
    FitAtOptions options;
    options.fit.kind = row.asked;
    options.fit.threshold = row.threshold;
    for (const std::size_t k : {0, 1}) {
        const FittedPrimitive found = fit_at(*cloud, {points[k].position}, {}, options);
        const ShapeFit& fit = found.primitive.fit;
        EXPECT_NE(fit.verdict, FitVerdict::good)
            << k << ": " << text_of(fit.shape) << ", " << found.points.size() << " points, noise " << fit.noise;
        EXPECT_FALSE(fit.message.empty());
        options.fit.kind = row.there;
        const ShapeFit right = fit_at(*cloud, {points[k].position}, {}, options).primitive.fit;
        EXPECT_EQ(right.verdict, FitVerdict::good) << k << ": " << right.message;
        options.fit.kind = row.asked;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, AskedOnAnother,
    testing::Values(Asked{"SphereOnPipe", ShapeKind::cylinder, ShapeKind::sphere, 0.5, 0},
                    Asked{"SphereOnPipe8mm", ShapeKind::cylinder, ShapeKind::sphere, 0.5, 0.008},
                    Asked{"SphereOnPipe20mm", ShapeKind::cylinder, ShapeKind::sphere, 0.5, 0.02},
                    Asked{"SphereOnThinPipe", ShapeKind::cylinder, ShapeKind::sphere, 0.1, 0},
                    Asked{"SphereOnThinPipe8mm", ShapeKind::cylinder, ShapeKind::sphere, 0.1, 0.008},
                    Asked{"PlaneOnPipe", ShapeKind::cylinder, ShapeKind::plane, 0.5, 0},
                    Asked{"PlaneOnPipe8mm", ShapeKind::cylinder, ShapeKind::plane, 0.5, 0.008},
                    Asked{"PlaneOnThinPipe", ShapeKind::cylinder, ShapeKind::plane, 0.1, 0},
                    Asked{"PlaneOnSphere", ShapeKind::sphere, ShapeKind::plane, 1, 0},
                    Asked{"PlaneOnSphere8mm", ShapeKind::sphere, ShapeKind::plane, 1, 0.008},
                    Asked{"CylinderOnSphere", ShapeKind::sphere, ShapeKind::cylinder, 1, 0},
                    Asked{"CylinderOnSphere8mm", ShapeKind::sphere, ShapeKind::cylinder, 1, 0.008},
                    Asked{"ConeOnPipe", ShapeKind::cylinder, ShapeKind::cone, 0.5, 0},
                    Asked{"ConeOnPipe8mm", ShapeKind::cylinder, ShapeKind::cone, 0.5, 0.008},
                    Asked{"CylinderOnCone", ShapeKind::cone, ShapeKind::cylinder, 0, 0},
                    Asked{"CylinderOnCone8mm", ShapeKind::cone, ShapeKind::cylinder, 0, 0.008},
                    Asked{"SphereOnCone", ShapeKind::cone, ShapeKind::sphere, 0, 0},
                    Asked{"CylinderOnTorus", ShapeKind::torus, ShapeKind::cylinder, 1.5, 0},
                    Asked{"CylinderOnTorus8mm", ShapeKind::torus, ShapeKind::cylinder, 1.5, 0.008}),
    [](const auto& info) { return std::string(info.param.what); });

}  // namespace
