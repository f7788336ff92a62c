// Input that does not determine a shape, or is extreme: a table of case and outcome. No case may throw, hang, or give
// NaN.
#include "tests/fit/fit_scenes.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

namespace pcm {
namespace {

using namespace scenes;

const Vec3d axis = normalised(Vec3d{1, 2, 3});

Shape typical(ShapeKind kind)
{
    switch (kind) {
        case ShapeKind::plane:
            return {kind, {0.3, 0.1, 0.2}, axis, 0, 0};
        case ShapeKind::cylinder:
            return {kind, {0.3, 0.1, 0.2}, axis, 0.3, 0};
        case ShapeKind::sphere:
            return {kind, {0.3, 0.1, 0.2}, {0, 0, 1}, 0.4, 0};
        case ShapeKind::cone:
            return {kind, {0.3, 0.1, 0.2}, axis, 0, 0.4};
        case ShapeKind::torus:
            break;
    }
    return {kind, {0.3, 0.1, 0.2}, axis, 0.5, 0.15};
}

void expect_no_nan(const ShapeFit& fit, const std::string& what)
{
    const Shape& s = fit.shape;
    EXPECT_TRUE(is_finite(s.point) && is_finite(s.axis)) << what;
    EXPECT_TRUE(std::isfinite(s.radius) && std::isfinite(s.second)) << what;
    for (const double number : {fit.errors.position, fit.errors.angle, fit.errors.radius, fit.errors.second,
                                fit.condition, fit.noise, fit.rms, fit.threshold})
        EXPECT_TRUE(number >= 0) << what;
    if (fit.has_shape()) EXPECT_NO_THROW(check(s)) << what;
    EXPECT_EQ(fit.verdict == FitVerdict::good, fit.issue == FitIssue::none) << what;
    EXPECT_EQ(fit.verdict == FitVerdict::good, fit.message.empty()) << what << ": " << fit.message;
}

FitPoints random_points(std::size_t count, const std::function<Vec3d(double, double, double)>& place)
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < count; ++i) points.push_back(place(uniform(random), uniform(random), uniform(random)));
    return FitPoints::of(points);
}

struct Case {
    const char* name;
    FitPoints points;
    std::set<FitIssue> curved, plane;  // possible outcomes; empty: good
};

std::vector<Case> cases()
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    const auto line = [](double u, double, double) { return Vec3d{u, 2 * u, 3 * u}; };
    const auto flat = [](double u, double v, double) { return Vec3d{u, v, 0}; };
    const auto slanted = [](double u, double v, double) { return Vec3d{u, v, u + 0.3 * v}; };
    const auto ball = [](double u, double v, double w) { return Vec3d{u, v, w}; };
    const auto far = [](double u, double v, double) { return Vec3d{5e5 + u, 4.8e6 + v, 100}; };
    FitPoints with_nan = random_points(100, ball), with_infinity = random_points(100, ball);
    with_nan.y[50] = nan;
    with_infinity.z[99] = -infinite;
    FitPoints bad_origin = random_points(100, ball);
    bad_origin.origin[0] = nan;
    return {
        {"no points", {}, {FitIssue::too_few_points}, {FitIssue::too_few_points}},
        {"one point", random_points(1, ball), {FitIssue::too_few_points}, {FitIssue::too_few_points}},
        {"two points", random_points(2, ball), {FitIssue::too_few_points}, {FitIssue::too_few_points}},
        {"NaN", with_nan, {FitIssue::not_finite}, {FitIssue::not_finite}},
        {"infinity", with_infinity, {FitIssue::not_finite}, {FitIssue::not_finite}},
        {"origin", bad_origin, {FitIssue::not_finite}, {FitIssue::not_finite}},
        {"coincident",
         random_points(50,
                       [](double, double, double) {
                           return Vec3d{1, 2, 3};
                       }),
         {FitIssue::coincident},
         {FitIssue::coincident}},
        {"collinear", random_points(50, line), {FitIssue::collinear}, {FitIssue::collinear}},
        {"flat", random_points(500, flat), {FitIssue::coplanar}, {FitIssue::none}},
        {"slanted", random_points(500, slanted), {FitIssue::coplanar}, {FitIssue::none}},
        {"flat at map coordinates", random_points(500, far), {FitIssue::coplanar}, {FitIssue::none}},
    };
}

TEST(DegenerateFits, HaveTheirNames)
{
    for (const Case& one : cases())
        for (const ShapeTraits& row : shape_kinds()) {
            const std::string what = std::string(one.name) + ", " + row.name;
            ShapeFitOptions options;
            options.kind = row.kind;
            for (const double threshold : {0.0, 0.01}) {
                options.threshold = threshold;
                const ShapeFit fit = fit_shape(one.points, options);
                expect_no_nan(fit, what);
                EXPECT_TRUE((row.kind == ShapeKind::plane ? one.plane : one.curved).count(fit.issue))
                    << what << ": " << name_of(fit.issue);
            }
            const ShapeFit refined = refine_shape(one.points, typical(row.kind));
            expect_no_nan(refined, what + ", refined");
            EXPECT_TRUE((row.kind == ShapeKind::plane ? one.plane : one.curved).count(refined.issue))
                << what << ", refined: " << name_of(refined.issue);
        }
}

TEST(DegenerateFits, FewPointsOfAShapeEndWithAResultOrAName)
{
    for (const ShapeTraits& row : shape_kinds())
        for (std::size_t count = 0; count <= 12; ++count)
            for (const Estimator estimator : {Estimator::msac, Estimator::prosac, Estimator::mlesac}) {
                SceneOptions scene;
                scene.points = count;
                scene.outliers = 0;
                ShapeFitOptions options;
                options.kind = row.kind;
                options.estimator = estimator;
                options.iterations = 200;
                options.threshold = 0.02;
                expect_no_nan(fit_shape(scene_of(typical(row.kind), scene).points, options),
                              std::to_string(count) + " points, " + row.name);
            }
}

TEST(DegenerateFits, ANoisyPlaneIsNoCurvedShape)
{
    SceneOptions scene;
    scene.outliers = 0;
    for (unsigned seed = 1; seed <= 10; ++seed)
        for (const ShapeKind kind : {ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone, ShapeKind::torus}) {
            scene.seed = seed;
            ShapeFitOptions options;
            options.kind = kind;
            options.threshold = 0.015;
            options.seed = seed;
            options.iterations = 1000;
            const ShapeFit fit = fit_shape(scene_of(typical(ShapeKind::plane), scene).points, options);
            expect_no_nan(fit, traits_of(kind).name);
            EXPECT_NE(fit.verdict, FitVerdict::good) << traits_of(kind).name << " " << text_of(fit.shape);
        }
}

TEST(DegenerateFits, OutliersAloneEndSoon)
{
    const FitPoints points = random_points(2000, [](double u, double v, double w) { return Vec3d{u, v, w}; });
    for (const ShapeTraits& row : shape_kinds())
        for (const EstimatorTraits& estimator : estimators()) {
            ShapeFitOptions options;
            options.kind = row.kind;
            options.estimator = estimator.estimator;
            options.threshold = 1e-4;
            options.iterations = 300;
            const ShapeFit fit = fit_shape(points, options);
            EXPECT_LE(fit.iterations, 300u);
            expect_no_nan(fit, std::string(row.name) + " " + estimator.name);
        }
}

// Every sample is degenerate: all points but a few are one point.
TEST(DegenerateFits, SamplesOfOnePlaceEnd)
{
    FitPoints points = random_points(1000, [](double, double, double) { return Vec3d{1, 1, 1}; });
    points.add({0, 0, 0});
    points.add({1, 0, 0.5});
    points.add({0, 1, 0.2});
    points.add({0.5, 0.1, 1});
    for (const ShapeTraits& row : shape_kinds())
        for (const EstimatorTraits& estimator : estimators()) {
            ShapeFitOptions options;
            options.kind = row.kind;
            options.estimator = estimator.estimator;
            options.threshold = 0.01;
            options.iterations = 2000;
            expect_no_nan(fit_shape(points, options), std::string(row.name) + " " + estimator.name);
        }
}

// About 1e-6 and 1e9: powers of two, so that nothing is rounded.
TEST(DegenerateFits, ExtremeExtentsGiveTheSameShape)
{
    for (const ShapeTraits& row : shape_kinds())
        for (const double scale : {0x1p-20, 0x1p30}) {
            SceneOptions scene_options;
            scene_options.points = 1500;
            Scene scene = scene_of(typical(row.kind), scene_options);
            ShapeFitOptions options;
            options.kind = row.kind;
            options.threshold = 0.015;
            const ShapeFit usual = fit_shape(scene.points, options);
            for (auto* column : {&scene.points.x, &scene.points.y, &scene.points.z})
                for (double& value : *column) value *= scale;
            scene.points.origin = scale * scene.points.origin;
            options.threshold *= scale;
            const ShapeFit fit = fit_shape(scene.points, options);
            EXPECT_EQ(fit.verdict, FitVerdict::good) << row.name << scale << fit.message;
            EXPECT_NEAR(fit.noise / scale, usual.noise, 1e-9 * usual.noise) << row.name << scale;
            EXPECT_LT(length(cross(fit.shape.axis, usual.shape.axis)), 1e-9) << row.name << scale;
            EXPECT_NEAR(fit.shape.radius / scale, usual.shape.radius, 1e-9) << row.name << scale;
            EXPECT_NEAR(fit.errors.angle, usual.errors.angle, 1e-6 * usual.errors.angle) << row.name << scale;
            EXPECT_NEAR(fit.errors.radius / scale, usual.errors.radius, 1e-6 * usual.errors.radius) << row.name;
        }
}

// Whose extent is so small that it has no inverse.
TEST(DegenerateFits, TheLeastNumbersAreAPlane)
{
    for (const double scale : {1e-307, 1e-309, 1e-312, 1e-316}) {
        const FitPoints flat = random_points(500, [](double u, double v, double w) {
            return Vec3d{u, v, w > 0.8 ? 0.3 : 0};
        });
        FitPoints points;
        for (std::size_t i = 0; i < flat.size(); ++i) points.add(Vec3d{1e-307, 0, 0} + scale * flat.source(i));
        const ShapeFit fit = fit_shape(points, {});
        ASSERT_EQ(fit.verdict, FitVerdict::good) << scale << fit.message;
        EXPECT_NEAR(std::fabs(fit.shape.axis[2]), 1, 1e-9) << scale;
        EXPECT_GT(fit.inliers, 350u) << scale;
    }
}

TEST(DegenerateFits, NormalsOfFewPoints)
{
    for (std::size_t count : {0u, 1u, 2u, 3u, 7u}) {
        FitPoints points = random_points(count, [](double u, double v, double) { return Vec3d{u, v, 0}; });
        estimate_normals(points, 100);
        ASSERT_EQ(points.nx.size(), count);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3d normal = points.normal(i);
            if (count < 3)
                EXPECT_EQ(normal, (Vec3d{}));
            else
                EXPECT_NEAR(std::fabs(normal[2]), 1, 1e-12);
        }
    }
    FitPoints line = random_points(50, [](double u, double, double) { return Vec3d{u, u, u}; });
    line.x[3] = std::numeric_limits<double>::quiet_NaN();
    estimate_normals(line);
    for (std::size_t i = 0; i < line.size(); ++i) EXPECT_EQ(line.normal(i), (Vec3d{}));
}

TEST(DegenerateFits, ThresholdOfPointsThatSayNothing)
{
    EXPECT_EQ(automatic_threshold({}), 0);
    EXPECT_EQ(automatic_threshold(random_points(50, [](double, double, double) { return Vec3d{1, 2, 3}; })), 0);
    FitPoints bad = random_points(100, [](double u, double v, double w) { return Vec3d{u, v, w}; });
    bad.x[0] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(automatic_threshold(bad), 0);
}

}  // namespace
}  // namespace pcm
