#include "pcm/fit/shape_fit.h"

#include "pcm/fit/shape_sums.h"
#include "tests/fit/fit_scenes.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using namespace scenes;

const Shape plane{ShapeKind::plane, {0.1, 0.2, 0.3}, normalised(Vec3d{1, 2, 3}), 0, 0};
const Shape cylinder{ShapeKind::cylinder, {0.1, 0.2, 0.3}, normalised(Vec3d{1, 2, 3}), 0.3, 0};
const Shape sphere{ShapeKind::sphere, {0.1, 0.2, 0.3}, {0, 0, 1}, 0.4, 0};

double error_of(const Shape& shape, const Shape& truth)
{
    const double angle = length(cross(shape.axis, truth.axis));
    if (truth.kind == ShapeKind::plane) return angle + distance_to(shape, truth.point);
    if (truth.kind == ShapeKind::sphere)
        return length(shape.point - truth.point) + std::fabs(shape.radius - truth.radius);
    return angle + length(cross(truth.axis, shape.point - truth.point)) + std::fabs(shape.radius - truth.radius);
}

TEST(FitShape, FindsPlaneCylinderSphereAmongOutliers)
{
    for (const Shape& shape : {plane, cylinder, sphere}) {
        std::vector<double> ratios;
        for (unsigned seed = 1; seed <= 20; ++seed) {
            SceneOptions scene_options;
            scene_options.seed = seed;
            const Scene scene = scene_of(shape, scene_options);
            ShapeFitOptions options;
            options.kind = shape.kind;
            options.threshold = 0.015;
            options.seed = seed;
            const ShapeFit fit = fit_shape(scene.points, options), best = oracle(scene);
            ASSERT_EQ(fit.verdict, FitVerdict::good) << fit.message;
            ratios.push_back(error_of(fit.shape, scene.truth) / error_of(best.shape, scene.truth));
        }
        std::sort(ratios.begin(), ratios.end());
        EXPECT_LT(ratios[10], 1.3) << traits_of(shape.kind).name;
    }
}

TEST(ShapeSums, StepsToTheResultOfRefinement)
{
    for (const Shape& shape : {plane, cylinder, sphere}) {
        SceneOptions scene_options;
        scene_options.outliers = 0;
        scene_options.offset = {5e5, 4.8e6, 100};
        const Scene scene = scene_of(shape, scene_options);
        const ShapeFit refined = refine_shape(scene.points, scene.truth);
        Shape at = scene.truth;
        ShapeFit result;
        for (int round = 0; round < 8; ++round) {
            ShapeSums sums(at, scene.points.origin, 1);
            for (std::size_t i = 0; i < scene.points.size(); ++i) sums.add(scene.points.source(i));
            result = sums.result(0);
            const auto next = sums.step();
            ASSERT_TRUE(next);
            at = *next;
        }
        EXPECT_EQ(result.verdict, FitVerdict::good) << result.message;
        EXPECT_LT(error_of(at, refined.shape), 1e-8);
        EXPECT_NEAR(result.rms, refined.rms, 1e-8);
        EXPECT_NEAR(result.errors.radius, refined.errors.radius, 1e-6 * refined.errors.radius);
    }
}

}  // namespace
}  // namespace pcm
