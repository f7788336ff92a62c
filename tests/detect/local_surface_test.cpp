// Paraboloids through points of known surfaces, and the shapes that curve as they do.
#include "pcm/detect/local_surface.h"

#include "tests/support.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace {

using namespace pcm;

// A patch of points around a place of a surface, in random order but for the place itself, which is first.
struct Patch {
    SurfaceSample sample;
    std::vector<std::uint32_t> points;

    void add(const Vec3d& p, const Vec3d& normal)
    {
        points.push_back(static_cast<std::uint32_t>(sample.at.size()));
        sample.at.push_back(p);
        sample.normal.push_back(
            {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])});
    }
    std::optional<LocalSurface> fit(double threshold) const
    {
        return fit_local_surface(sample, points.data(), points.size(), threshold);
    }
};

// Points of a shape within `reach` of its point nearest to `near`, displaced along their normals.
Patch patch_of(const Shape& shape, const Vec3d& near, double reach, double noise, std::size_t count, unsigned seed)
{
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(-reach, reach);
    const auto on = [&](const Vec3d& p) { return p - signed_distance(shape, p) * normal_at(shape, p); };
    const Vec3d place = on(near);
    Patch patch;
    patch.add(place, normal_at(shape, place));
    while (patch.points.size() < count) {
        const Vec3d p = on(place + Vec3d{unit(random), unit(random), unit(random)});
        if (length(p - place) > reach) continue;
        const Vec3d n = normal_at(shape, p);
        patch.add(p + noise * normal(random) * n, n);
    }
    return patch;
}

const std::vector<ShapeKind> all_kinds{ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere};

const Shape* of_kind(const std::vector<Shape>& shapes, ShapeKind kind)
{
    const auto found = std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.kind == kind; });
    return found == shapes.end() ? nullptr : &*found;
}

TEST(LocalSurface, HasTheCoefficientsOfAParaboloid)
{
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(-0.4, 0.4);
    for (int round = 0; round < 30; ++round) {
        const Vec3d up = normalised(Vec3d{normal(random), normal(random), normal(random)}), place{3, -2, 7};
        Patch patch;
        patch.add(place, up);
        // The frame is the fit's; any other point only sets it.
        for (int i = 0; i < 20; ++i) patch.add(place + Vec3d{unit(random), unit(random), unit(random)}, up);
        const auto frame = patch.fit(10);
        ASSERT_TRUE(frame);
        EXPECT_NEAR(length(frame->z - up), 0, 1e-6);
        EXPECT_NEAR(dot(frame->x, frame->y), 0, 1e-9);
        EXPECT_NEAR(dot(cross(frame->x, frame->y), frame->z), 1, 1e-6);
        const double c0 = 0.01 * normal(random), c1 = 0.1 * normal(random), c2 = 0.1 * normal(random),
                     xx = normal(random), xy = normal(random), yy = normal(random), noise = round % 2 ? 0.001 : 0;
        Patch curved;
        curved.add(place, up);
        double extent = 0;
        for (int i = 0; i < 400; ++i) {
            const double x = unit(random), y = unit(random);
            const double z = c0 + c1 * x + c2 * y + (xx * x * x + 2 * xy * x * y + yy * y * y) / 2;
            const bool outlier = i % 10 == 0;
            curved.add(place + x * frame->x + y * frame->y + (z + (outlier ? 5 : noise * normal(random))) * frame->z,
                       up);
            extent = std::max(extent, std::hypot(x, y));
        }
        curved.sample.at[0] = place;  // off the surface by c0
        const auto found = curved.fit(100);
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->extent, extent, 1e-6);
        Patch without;
        without.add(place, up);
        for (std::size_t i = 1; i < curved.sample.at.size(); ++i)
            if ((i - 1) % 10) without.add(curved.sample.at[i], up);
        const auto clean = without.fit(noise > 0 ? 0.1 : 0.05);
        ASSERT_TRUE(clean);
        const double close = noise > 0 ? 0.02 : 2e-3;
        EXPECT_NEAR(clean->c0, c0, 0.1 * close);
        EXPECT_NEAR(clean->c1, c1, close);
        EXPECT_NEAR(clean->c2, c2, close);
        EXPECT_NEAR(clean->xx, xx, 5 * close);
        EXPECT_NEAR(clean->xy, xy, 5 * close);
        EXPECT_NEAR(clean->yy, yy, 5 * close);
        if (noise > 0 && std::fabs(c0) < 0.003) EXPECT_NEAR(clean->rms, noise, 0.3 * noise);
    }
}

// Noise, the share of points near it, and how sure the curvature is, from many patches of one surface.
TEST(LocalSurface, KnowsItsNoiseAndTheErrorOfItsCurvature)
{
    const Shape sphere{ShapeKind::sphere, {1, 2, 3}, {0, 0, 1}, 2, 0};
    double squares = 0, stated = 0, noises = 0;
    const int rounds = 60;
    for (int round = 0; round < rounds; ++round) {
        Patch patch = patch_of(sphere, {1, 2, 9}, 0.3, 0.002, 120, static_cast<unsigned>(round));
        std::size_t near = patch.points.size();
        for (int i = 0; i < 12; ++i) patch.add(patch.sample.at[0] + Vec3d{0.02 * i, 0.01, -0.3}, {0, 0, 1});
        const auto found = patch.fit(0.05);
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->near, double(near) / double(patch.points.size()), 0.12);
        const auto clean = patch_of(sphere, {1, 2, 9}, 0.3, 0.002, 120, static_cast<unsigned>(round)).fit(0.05);
        ASSERT_TRUE(clean);
        EXPECT_EQ(clean->near, 1);
        noises += clean->rms * clean->rms / rounds;
        stated += clean->curvature_error * clean->curvature_error / rounds;
        squares += (clean->xx + 0.5) * (clean->xx + 0.5) / rounds;
    }
    EXPECT_NEAR(std::sqrt(noises), 0.002, 0.0003);
    EXPECT_NEAR(std::sqrt(stated / squares), 1, 0.35);
}

TEST(LocalSurface, ThereIsNoneWherePointsDetermineNone)
{
    const Shape plane{ShapeKind::plane, {0, 0, 0}, {0, 0, 1}, 0, 0};
    EXPECT_FALSE(patch_of(plane, {}, 1, 0, 7, 1).fit(1));
    EXPECT_TRUE(patch_of(plane, {}, 1, 0, 8, 1).fit(1));
    Patch line, one_place, without_normal = patch_of(plane, {}, 1, 0, 30, 1), far = patch_of(plane, {}, 1, 0, 30, 1);
    for (int i = 0; i < 30; ++i) {
        line.add({0.1 * i, 0.2 * i, 0}, {0, 0, 1});
        one_place.add({1, 1, 1}, {0, 0, 1});
    }
    EXPECT_FALSE(line.fit(1));
    EXPECT_FALSE(one_place.fit(1));
    without_normal.sample.normal[0] = {0, 0, 0};
    EXPECT_FALSE(without_normal.fit(1));
    for (std::size_t i = 0; i < 30; ++i) far.sample.at[i][2] = i % 2 ? 1 : -1;
    EXPECT_FALSE(far.fit(1e-3)) << "none is near the first one";
}

// The true one is among them, on either side of the surface, at any radius.
TEST(LocalSurface, ShapesLikeItCurveAsItDoes)
{
    for (const double radius : {0.05, 1.0, 300.0})
        for (const double side : {1.0, -1.0})
            for (unsigned seed = 0; seed < 10; ++seed) {
                std::mt19937_64 random(seed);
                std::normal_distribution<double> normal;
                const Vec3d axis = normalised(Vec3d{normal(random), normal(random), normal(random)});
                const Vec3d near = radius * Vec3d{normal(random), normal(random), normal(random)};
                for (const ShapeKind kind : {ShapeKind::cylinder, ShapeKind::sphere}) {
                    const Shape truth{kind, {5, 6, 7}, axis, radius, 0};
                    Patch patch = patch_of(truth, truth.point + near, 0.1 * radius, 1e-5 * radius, 200, seed);
                    for (auto& n : patch.sample.normal)
                        for (float& v : n) v *= static_cast<float>(side);
                    const auto surface = patch.fit(0.01 * radius);
                    ASSERT_TRUE(surface);
                    const std::vector<Shape> shapes = shapes_like(*surface, all_kinds);
                    const Shape* found = of_kind(shapes, kind);
                    ASSERT_TRUE(found);
                    EXPECT_NEAR(found->radius / radius, 1, 0.03);
                    if (kind == ShapeKind::sphere) {
                        EXPECT_NEAR(length(found->point - truth.point) / radius, 0, 0.03);
                        EXPECT_FALSE(of_kind(shapes, ShapeKind::cylinder)) << "it curves in both directions";
                    } else {
                        EXPECT_NEAR(std::fabs(dot(found->axis, axis)), 1, 0.002);
                        const Vec3d d = found->point - truth.point;
                        EXPECT_NEAR(length(d - dot(d, axis) * axis) / radius, 0, 0.03);
                        EXPECT_FALSE(of_kind(shapes, ShapeKind::sphere)) << "it is straight in one direction";
                    }
                    const Shape* plane = of_kind(shapes, ShapeKind::plane);
                    ASSERT_TRUE(plane);
                    EXPECT_NEAR(std::fabs(dot(plane->axis, normal_at(truth, patch.sample.at[0]))), 1, 1e-4);
                    EXPECT_NEAR(distance_to(*plane, patch.sample.at[0]) / radius, 0, 1e-4);
                    EXPECT_EQ(shapes_like(*surface, {kind}).size(), 1u) << "only the kinds asked for";
                }
            }
}

TEST(LocalSurface, APlaneCurvesAsNothingElse)
{
    const Shape plane{ShapeKind::plane, {0, 0, 0}, normalised(Vec3d{1, 2, 3}), 0, 0};
    int curved = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const auto surface = patch_of(plane, {}, 1, 0.001, 200, seed).fit(0.1);
        ASSERT_TRUE(surface);
        const std::vector<Shape> shapes = shapes_like(*surface, all_kinds);
        ASSERT_TRUE(of_kind(shapes, ShapeKind::plane));
        for (const Shape& shape : shapes) curved += shape.kind != ShapeKind::plane && shape.radius < 50;
    }
    EXPECT_EQ(curved, 0);
}

}  // namespace
