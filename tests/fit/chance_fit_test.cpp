// Many outliers: what is found is right, or it is doubted.
#include "tests/fit/fit_scenes.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using namespace scenes;

const Shape cylinder{ShapeKind::cylinder, {0.3, 0.1, 0.2}, normalised(Vec3d{1, 2, 3}), 0.5, 0};

Scene scene_of_cylinder(std::uint64_t seed, double outliers)
{
    SceneOptions options;
    options.seed = seed;
    options.outliers = outliers;
    options.length = 3;
    Scene scene = scene_of(cylinder, options);
    estimate_normals(scene.points);  // from neighbours most of which are outliers
    return scene;
}

ShapeFit fit_of(const Scene& scene, Estimator estimator, std::uint64_t seed, std::uint32_t iterations)
{
    ShapeFitOptions options;
    options.kind = scene.truth.kind;
    options.estimator = estimator;
    options.threshold = 0.015;
    options.seed = seed;
    options.iterations = iterations;
    return fit_shape(scene.points, options);
}

bool is_right(const ShapeFit& fit)
{
    return fit.has_shape() && std::fabs(fit.shape.radius - cylinder.radius) < 0.015 &&
           length(cross(fit.shape.axis, cylinder.axis)) < 0.015;
}

TEST(ChanceFits, ACylinderAmongFourTimesAsManyOutliersIsFound)
{
    for (const Estimator estimator : {Estimator::msac, Estimator::ransac, Estimator::prosac}) {
        unsigned right = 0;
        for (std::uint64_t seed = 1; seed <= 30; ++seed) {
            const ShapeFit fit = fit_of(scene_of_cylinder(seed, 0.8), estimator, seed, 10000);
            EXPECT_TRUE(is_right(fit) || fit.verdict != FitVerdict::good) << text_of(fit.shape);
            right += is_right(fit) && fit.verdict == FitVerdict::good;
        }
        EXPECT_GE(right, 29u) << traits_of(estimator).name;
    }
}

TEST(ChanceFits, ThePretestKeepsSamplesOfRoughNormals)
{
    unsigned right = 0;
    for (const Estimator estimator : {Estimator::rransac, Estimator::rmsac})
        for (std::uint64_t seed = 1; seed <= 30; ++seed) {
            const ShapeFit fit = fit_of(scene_of_cylinder(seed, 0.8), estimator, seed, 10000);
            EXPECT_TRUE(is_right(fit) || fit.verdict != FitVerdict::good) << text_of(fit.shape);
            right += is_right(fit) && fit.verdict == FitVerdict::good;
        }
    EXPECT_GE(right, 57u);
}

TEST(ChanceFits, WhatTooFewSamplesFindIsDoubted)
{
    unsigned wrong = 0, right = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const ShapeFit fit = fit_of(scene_of_cylinder(seed, 0.8), Estimator::msac, seed, 100);
        if (is_right(fit)) {
            EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
            ++right;
            continue;
        }
        ++wrong;
        EXPECT_NE(fit.verdict, FitVerdict::good) << text_of(fit.shape) << " " << fit.inliers;
        if (fit.verdict == FitVerdict::doubtful) EXPECT_NE(fit.issue, FitIssue::none) << fit.message;
    }
    EXPECT_GT(wrong, 15u);  // or nothing is tested
    EXPECT_GT(right, 3u) << right;
}

// Estimated normals of few outliers are good, and few samples are enough; of many they are not.
TEST(ChanceFits, SamplesAreAsManyAsTheNormalsAskFor)
{
    std::uint64_t few = 0, many = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        few += fit_of(scene_of_cylinder(seed, 0.3), Estimator::msac, seed, 10000).iterations;
        many += fit_of(scene_of_cylinder(seed, 0.8), Estimator::msac, seed, 10000).iterations;
    }
    EXPECT_LT(few, 20 * 25u);
    EXPECT_GT(many, 20 * 1600u);
    EXPECT_LT(many, 20 * 2600u);  // least squares brings rough samples to the surface
}

// A bend of a seventh of the noise is certain by the number of points alone.
TEST(ChanceFits, ABendFarWithinTheNoiseIsDoubted)
{
    SceneOptions options;
    options.points = 20000;
    options.outliers = 0;
    options.noise = 0.001;
    options.arc = 2 * std::asin(0.5 / 240);
    const Scene scene = scene_of({ShapeKind::sphere, {0, 0, 0}, {0, 0, 1}, 240, 0}, options);
    const ShapeFit fit = fit_of(scene, Estimator::msac, 1, 1000);
    EXPECT_EQ(fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(fit.issue, FitIssue::thin_arc) << fit.message;
    EXPECT_GT(fit.shape.radius, 11 * fit.errors.radius);
}

// Errors that neighbours share: waves as high as the noise bend a plane more than chance does.
TEST(ChanceFits, ErrorsThatNeighboursShareAreNoCurvature)
{
    unsigned good = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> gauss;
        std::uniform_real_distribution<double> uniform(-0.5, 0.5);
        const double phase = 6 * uniform(random), turn = uniform(random);
        FitPoints points;
        for (int i = 0; i < 8000; ++i) {
            const double x = uniform(random), y = uniform(random), wave = std::sin(9 * (x + turn * y) + phase);
            points.add({x, y, 0.001 * (wave + 0.5 * gauss(random))});
        }
        for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::cylinder}) {
            ShapeFitOptions options;
            options.kind = kind;
            options.threshold = 0.004;
            good += fit_shape(points, options).verdict == FitVerdict::good;
        }
    }
    EXPECT_LE(good, 2u);
}

}  // namespace
}  // namespace pcm
