// How far a polish is from where it would end.
#include "pcm/fit/least_squares.h"

#include "tests/fit/fit_scenes.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using namespace scenes;

WorkingPoints working_of(const FitPoints& points, ShapeKind kind)
{
    PointSpread spread;
    EXPECT_EQ(obvious_issue(points, kind, model_of(kind).parameters(), spread), FitIssue::none);
    return working_points(points, spread, 1);
}

// Root mean square of the differences of the points' distances from two shapes.
double difference(const Shape& a, const Shape& b, const WorkingPoints& points)
{
    double squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double d = signed_distance(a, points.at(i)) - signed_distance(b, points.at(i));
        squares += d * d;
    }
    return std::sqrt(squares / static_cast<double>(points.size()));
}

TEST(LeastSquares, EndsWhereStepsWouldChangeNothing)
{
    for (const Shape& shape : one_of_each_kind())
        for (const double share : {1.0, 0.9})
            for (std::uint64_t seed = 1; seed <= 5; ++seed) {
                SceneOptions options;
                options.seed = seed;
                const Scene scene = scene_of(shape, options);
                const WorkingPoints points = working_of(scene.points, shape.kind);
                const ShapeModel& model = model_of(shape.kind);
                Shape from = points.to_working(scene.truth);
                from.point = from.point + Vec3d{0.003, -0.002, 0.002};
                PatchBand band{0.015 / points.unit};
                band.share = share;
                const SurfacePatch start = model.patch_at(from, {});
                const PolishedPatch last = polish(model, start, points, band, 200, 1e-15);
                // To first order, the error of a distance that the errors of all parameters make.
                const double error = last.noise() * std::sqrt(static_cast<double>(model.parameters()) / last.sums.used);
                for (const double enough : {1e-2, 1e-7}) {
                    const PolishedPatch found = polish(model, start, points, band, 50, enough);
                    EXPECT_TRUE(found.converged) << traits_of(shape.kind).name;
                    EXPECT_LT(difference(model.shape_of(found.patch), model.shape_of(last.patch), points),
                              3 * std::sqrt(enough) * error)
                        << traits_of(shape.kind).name << ' ' << share << ' ' << seed << ' ' << enough;
                }
            }
}

// Without points by chance all weights are equal up to nine tenths of the threshold; else bins show the noise.
TEST(LeastSquares, AMixtureLearnsWhereThereIsSomethingToLearn)
{
    DistanceBins bins;
    for (std::size_t i = 0; i < DistanceBins::size; ++i) {
        const double c = 5 * (static_cast<double>(i) + 0.5) / DistanceBins::size;
        bins.counts[i] = 100 * std::exp(-c * c / 2) + 5;
    }
    NoiseMixture all(0.1, 1);
    EXPECT_FALSE(all.needs_bins());
    EXPECT_FALSE(all.learn(bins, 0.02));
    EXPECT_TRUE(all.all_belong());
    EXPECT_FALSE(NoiseMixture().needs_bins());
    double points = 0;
    for (const double count : bins.counts) points += count;
    NoiseMixture some(0.1, 1 - 5 * DistanceBins::size / points);
    EXPECT_TRUE(some.needs_bins());
    EXPECT_TRUE(some.learn(bins, 0.02));
    EXPECT_FALSE(some.all_belong());
    EXPECT_NEAR(some.deviation(), 0.02, 0.0002);
}

TEST(LeastSquares, FactsOfABandAreThoseOfItsOutliers)
{
    SceneOptions options;
    options.outliers = 0.6;
    const Scene scene = scene_of(one_of_each_kind()[0], options);
    const WorkingPoints points = working_of(scene.points, ShapeKind::plane);
    const double threshold = 0.015 / points.unit;
    const ShapeModel& model = model_of(ShapeKind::plane);
    const PolishedPatch polished =
        polish(model, model.patch_at(points.to_working(scene.truth), {}), points, {threshold}, 50, 1e-7);
    double near = 0, by_chance = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (std::fabs(signed_distance(scene.truth, scene.points.source(points.index[i]))) <= 0.015) {
            near += 1;
            by_chance += !scene.is_true[points.index[i]];
        }
    const BandFacts facts = band_facts(model, polished, points, threshold);
    EXPECT_NEAR(facts.chance, by_chance / near, 3 * std::sqrt(2 * by_chance) / near);
    EXPECT_GT(facts.influence, 1);
}

}  // namespace
}  // namespace pcm
