// What options do, and what is refused.
#include "pcm/fit/near_tree.h"
#include "pcm/system/error.h"
#include "tests/fit/fit_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace pcm {
namespace {

using namespace scenes;

const Shape cylinder{ShapeKind::cylinder, {0.3, 0.1, 0.2}, normalised(Vec3d{1, 2, 3}), 0.3, 0};

ShapeFitOptions usual()
{
    ShapeFitOptions options;
    options.kind = ShapeKind::cylinder;
    options.threshold = 0.015;
    return options;
}

template <class Change>
ErrorCode refusal(const Change& change)
{
    ShapeFitOptions options = usual();
    change(options);
    try {
        fit_shape(scene_of(cylinder, {}).points, options);
    } catch (const Error& error) {
        return error.code();
    }
    return ErrorCode::io;
}

TEST(FitOptions, OutOfRangeAreRefused)
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const auto bad = ErrorCode::invalid_argument;
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.threshold = -1; }), bad);
    EXPECT_EQ(refusal([&](ShapeFitOptions& o) { o.threshold = nan; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.probability = 0; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.probability = 1; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.iterations = 0; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.seconds = -1; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.least_radius = -1; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.least_radius = o.largest_radius = 1; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.normal_angle = 0; }), bad);
    EXPECT_EQ(refusal([](ShapeFitOptions& o) { o.progress = [](const ProgressUpdate&) { return false; }; }),
              ErrorCode::cancelled);
    RefineOptions refine;
    refine.threshold = 0;
    EXPECT_THROW(refine_shape({}, cylinder, refine), Error);
}

TEST(FitOptions, TheSeedDecides)
{
    const Scene scene = scene_of(cylinder, {});
    for (const EstimatorTraits& row : estimators()) {
        ShapeFitOptions options = usual();
        options.estimator = row.estimator;
        const ShapeFit first = fit_shape(scene.points, options), second = fit_shape(scene.points, options);
        EXPECT_EQ(text_of(first.shape), text_of(second.shape)) << row.name;
        EXPECT_EQ(first.iterations, second.iterations) << row.name;
        EXPECT_EQ(first.is_inlier, second.is_inlier) << row.name;
    }
}

TEST(FitOptions, TimeAndSamplesEndTheSearch)
{
    SceneOptions noise;
    noise.outliers = 1;
    const Scene scene = [&] {
        Scene only = scene_of(cylinder, {});
        std::mt19937_64 random(3);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (auto* column : {&only.points.x, &only.points.y, &only.points.z})
            for (double& value : *column) value = uniform(random);
        return only;
    }();
    ShapeFitOptions options = usual();
    options.threshold = 1e-4;
    options.iterations = 77;
    EXPECT_EQ(fit_shape(scene.points, options).iterations, 77u);
    options.iterations = 4000000000u;
    options.seconds = 0.05;
    const ShapeFit timed = fit_shape(scene.points, options);
    EXPECT_LT(timed.iterations, 4000000000u);
    EXPECT_GE(timed.seconds, 0.05);
}

TEST(FitOptions, ProbabilityAsksForSamples)
{
    SceneOptions scene;
    scene.outliers = 0.6;
    const FitPoints points = scene_of(cylinder, scene).points;
    ShapeFitOptions options = usual();
    std::vector<std::uint64_t> samples;
    for (const double probability : {0.5, 0.99, 0.999999}) {
        options.probability = probability;
        samples.push_back(fit_shape(points, options).iterations);
    }
    EXPECT_LT(samples[0], samples[1]);
    EXPECT_LT(samples[1], samples[2]);
}

TEST(FitOptions, RadiiOutsideOfTheRangeAreNotFound)
{
    const Scene scene = scene_of(cylinder, {});
    ShapeFitOptions options = usual();
    options.largest_radius = 0.2;
    ShapeFit fit = fit_shape(scene.points, options);
    EXPECT_TRUE(fit.has_shape() ? fit.shape.radius <= 0.2 : fit.issue == FitIssue::out_of_range) << fit.message;
    options.largest_radius = 1;
    options.least_radius = 0.5;
    fit = fit_shape(scene.points, options);
    EXPECT_TRUE(fit.has_shape() ? fit.shape.radius >= 0.5 : fit.issue == FitIssue::out_of_range) << fit.message;
    options.least_radius = 0.25;
    options.largest_radius = 0.35;
    EXPECT_EQ(fit_shape(scene.points, options).verdict, FitVerdict::good);
}

TEST(FitOptions, PointsWithOtherNormalsAreNoInliers)
{
    SceneOptions scene_options;
    scene_options.outliers = 0;
    Scene scene = scene_of(cylinder, scene_options);
    const std::size_t n = scene.points.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d normal = i % 4 == 0 ? cylinder.axis : normal_at(cylinder, scene.points.source(i));
        const double sign = i % 2 == 0 ? 1 : -1;
        scene.points.nx.push_back(sign * normal[0]);
        scene.points.ny.push_back(sign * normal[1]);
        scene.points.nz.push_back(sign * normal[2]);
    }
    ShapeFitOptions options = usual();
    options.threshold = 0.03;
    options.normal_angle = 0.2;
    const ShapeFit fit = fit_shape(scene.points, options);
    ASSERT_EQ(fit.verdict, FitVerdict::good) << fit.message;
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(fit.is_inlier[i], i % 4 != 0) << i;
    EXPECT_EQ(fit.inliers, n - (n + 3) / 4);
    options.normal_angle = 2;
    EXPECT_EQ(fit_shape(scene.points, options).inliers, n);
    RefineOptions refine;
    refine.normal_angle = 0.2;
    EXPECT_EQ(refine_shape(scene.points, cylinder, refine).inliers, n - (n + 3) / 4);
}

TEST(FitOptions, TheReportIsThatOfTheInliers)
{
    const Scene scene = scene_of(cylinder, {});
    const ShapeFit fit = fit_shape(scene.points, usual());
    ASSERT_EQ(fit.is_inlier.size(), scene.points.size());
    std::uint64_t inliers = 0;
    double squares = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
        const double distance = distance_to(fit.shape, scene.points.source(i));
        EXPECT_EQ(fit.is_inlier[i], distance <= fit.threshold) << distance;
        if (distance > fit.threshold) continue;
        ++inliers;
        squares += distance * distance;
    }
    EXPECT_EQ(fit.inliers, inliers);
    EXPECT_NEAR(fit.rms, std::sqrt(squares / static_cast<double>(inliers)), 1e-9);
    EXPECT_NEAR(fit.noise, 0.005, 0.0005);
    EXPECT_EQ(fit.threshold, 0.015);
    EXPECT_GT(fit.condition, 1);
    EXPECT_GT(fit.iterations, 0u);
    EXPECT_GT(fit.seconds, 0);
    EXPECT_EQ(fit.errors.second, 0);
}

TEST(NearTree, FindsWhatAComparisonOfAllFinds)
{
    std::mt19937_64 random(5);
    for (const double grid : {0.0, 0.25}) {
        std::uniform_real_distribution<double> uniform(0, 1);
        std::vector<double> x, y, z;
        for (int i = 0; i < 700; ++i)
            for (auto* column : {&x, &y, &z}) {
                const double value = uniform(random);
                column->push_back(grid > 0 ? grid * std::floor(value / grid) : value);
            }
        const NearTree tree(x, y, z);
        std::vector<NearTree::Near> near;
        for (std::size_t i = 0; i < x.size(); i += 7)
            for (const std::size_t count : {std::size_t(1), std::size_t(9), std::size_t(700), std::size_t(900)}) {
                const Vec3d place{x[i], y[i], z[i]};
                tree.nearest(place, count, near);
                std::vector<double> squares;
                for (std::size_t k = 0; k < x.size(); ++k)
                    squares.push_back(squared_distance({x[k], y[k], z[k]}, place));
                std::sort(squares.begin(), squares.end());
                ASSERT_EQ(near.size(), std::min(count, x.size()));
                for (std::size_t k = 0; k < near.size(); ++k) {
                    ASSERT_EQ(near[k].square, squares[k]);
                    ASSERT_EQ(near[k].square,
                              squared_distance({x[near[k].index], y[near[k].index], z[near[k].index]}, place));
                }
            }
    }
}

TEST(Normals, AreThoseOfTheSurface)
{
    SceneOptions options;
    options.outliers = 0;
    options.noise = 1e-4;
    Scene scene = scene_of(cylinder, options);
    scene.points.x[5] = std::numeric_limits<double>::quiet_NaN();
    estimate_normals(scene.points);
    EXPECT_EQ(scene.points.normal(5), (Vec3d{}));
    double worst = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
        if (i == 5) continue;
        EXPECT_NEAR(length(scene.points.normal(i)), 1, 1e-12);
        worst = std::max(worst, length(cross(scene.points.normal(i), normal_at(cylinder, scene.points.source(i)))));
    }
    EXPECT_LT(worst, 0.3);
}

}  // namespace
}  // namespace pcm
