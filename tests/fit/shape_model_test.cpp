#include "pcm/fit/models/shape_model.h"

#include "pcm/fit/shape_distances.h"
#include "tests/fit/fit_scenes.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using namespace scenes;

// Numbers that a kind does not have are 0, whatever makes the shape: shapes are compared and written as a whole.
void expect_own_numbers(const Shape& shape, ShapeKind kind)
{
    const ShapeTraits& row = traits_of(kind);
    EXPECT_EQ(shape.kind, kind);
    if (!row.has_radius()) EXPECT_EQ(shape.radius, 0) << row.name;
    if (!row.has_size(&Shape::second)) EXPECT_EQ(shape.second, 0) << row.name;
}

TEST(ShapeModels, OneRowPerKindWithConsistentNumbers)
{
    for (const ShapeTraits& row : shape_kinds()) {
        const ShapeModel& model = model_of(row.kind);
        EXPECT_EQ(model.kind(), row.kind);
        EXPECT_LE(model.parameters(), most_parameters);
        EXPECT_LE(model.sampled, most_sampled);
    }
}

TEST(ShapeModels, DistancesOfBlocksAreThoseOfPoints)
{
    for (const Shape& shape : one_of_each_kind()) {
        const Scene scene = scene_of(shape, {});
        std::vector<double> out(scene.points.size());
        Shape local = shape;
        local.point = shape.point - scene.points.origin;
        signed_distances(local, scene.points.x.data(), scene.points.y.data(), scene.points.z.data(), out.size(),
                         out.data());
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_NEAR(out[i], signed_distance(shape, scene.points.source(i)), 1e-14) << traits_of(shape.kind).name;
    }
}

TEST(ShapeModels, APatchIsItsShape)
{
    for (const Shape& shape : one_of_each_kind()) {
        const ShapeModel& model = model_of(shape.kind);
        SceneOptions options;
        options.outliers = 0;
        options.noise = 0.02;
        const Scene scene = scene_of(shape, options);
        for (const Vec3d& middle : {Vec3d{0, 0, 0}, Vec3d{1, 0, 1}, Vec3d{-2, 1, 5}, shape.point}) {
            const SurfacePatch patch = model.patch_at(shape, middle);
            EXPECT_NEAR(signed_distance(shape, patch.place), 0, 1e-14);
            EXPECT_NEAR(length(patch.normal() - normal_at(shape, patch.place)), 0, 1e-12);
            const Shape back = model.shape_of(patch);
            EXPECT_TRUE(is_proper(back));
            expect_own_numbers(back, shape.kind);
            PatchBlock block;
            model.differentiate(patch, scene.points.x.data(), scene.points.y.data(), scene.points.z.data(), patch_block,
                                block);
            for (std::size_t i = 0; i < patch_block; ++i) {
                const Vec3d p = scene.points.at(i);
                EXPECT_NEAR(signed_distance(back, p), signed_distance(shape, p), 1e-12);
                if (shape.kind != ShapeKind::cone || dot(p - shape.point, shape.axis) > 0)
                    EXPECT_NEAR(block.distance[i], signed_distance(shape, p), 1e-12) << traits_of(shape.kind).name;
            }
        }
    }
}

// Also of patches that are curved inwards or not at all.
TEST(ShapeModels, DerivativesAreThoseOfMoves)
{
    for (const Shape& shape : one_of_each_kind())
        for (const double bend : {1.0, -1.0, 0.0}) {
            const ShapeModel& model = model_of(shape.kind);
            const Scene scene = scene_of(shape, {});
            SurfacePatch patch = model.patch_at(shape, {1, 0.5, 0});
            patch.curvature *= bend;
            const auto distances = [&](const SurfacePatch& of) {
                PatchBlock block;
                model.differentiate(of, scene.points.x.data(), scene.points.y.data(), scene.points.z.data(),
                                    patch_block, block);
                return block;
            };
            const PatchBlock block = distances(patch);
            for (std::size_t j = 0; j < model.parameters(); ++j) {
                std::array<double, most_parameters> step{};
                const double small = 1e-5;
                step[j] = small;
                const PatchBlock high = distances(model.moved(patch, step.data()));
                step[j] = -small;
                const PatchBlock low = distances(model.moved(patch, step.data()));
                for (std::size_t i = 0; i < patch_block; ++i) {
                    const double by = (high.distance[i] - low.distance[i]) / (2 * small);
                    ASSERT_NEAR(block.by[j][i], by, 1e-6 * (1 + std::fabs(by)))
                        << traits_of(shape.kind).name << " parameter " << j << " bend " << bend;
                }
            }
        }
}

TEST(ShapeModels, MinimalSamplesGiveTheShapeBack)
{
    for (const Shape& shape : one_of_each_kind()) {
        const ShapeModel& model = model_of(shape.kind);
        SceneOptions options;
        options.outliers = 0;
        options.noise = 0;
        const Scene scene = scene_of(shape, options);
        std::size_t found = 0;
        for (std::size_t i = 0; i + model.sampled <= 200; i += model.sampled) {
            SampledPoint sample[most_sampled];
            for (std::size_t k = 0; k < model.sampled; ++k) {
                sample[k].place = scene.points.source(i + k);
                sample[k].normal = normal_at(shape, sample[k].place);
            }
            Shape solutions[most_solutions];
            const std::size_t count = model.solve(sample, solutions);
            ASSERT_LE(count, most_solutions);
            for (std::size_t s = 0; s < count; ++s) {
                expect_own_numbers(solutions[s], shape.kind);
                double worst = 0;
                for (std::size_t at = 0; at < scene.points.size(); at += 37)
                    worst = std::max(worst, distance_to(solutions[s], scene.points.source(at)));
                if (worst < 1e-6) {
                    ++found;
                    break;
                }
            }
        }
        EXPECT_GE(found, 190 / model.sampled) << traits_of(shape.kind).name;
    }
}

}  // namespace
}  // namespace pcm
