// Places of a scene in a picture, against plain products of matrices in long double.
#include "pcm/view/screen_map.h"

#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

Matrix4d perspective(double half, double near, double far)
{
    Matrix4d p{};
    p[0] = p[5] = 1 / half;
    p[10] = -(far + near) / (far - near);
    p[11] = -1;
    p[14] = -2 * far * near / (far - near);
    return p;
}

Matrix4d orthographic(double half, double near, double far)
{
    Matrix4d p = identity();
    p[0] = p[5] = 1 / half;
    p[10] = -2 / (far - near);
    p[14] = -(far + near) / (far - near);
    return p;
}

// The window's place by the definition.
std::array<long double, 3> by_products(const Camera& camera, const Vec3d& p)
{
    const auto times = [](const Matrix4d& m, const std::array<long double, 4>& v) {
        std::array<long double, 4> r{};
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t k = 0; k < 4; ++k) r[i] += static_cast<long double>(m[k * 4 + i]) * v[k];
        return r;
    };
    std::array<long double, 4> v{0, 0, 0, 1};
    for (std::size_t a = 0; a < 3; ++a)
        v[a] = static_cast<long double>(p[a]) - static_cast<long double>(camera.origin[a]);
    const auto clip = times(camera.projection, times(camera.modelview, v));
    return {(clip[0] / clip[3] + 1) / 2 * camera.width, (clip[1] / clip[3] + 1) / 2 * camera.height, clip[2] / clip[3]};
}

}  // namespace

TEST(ScreenMap, PlacesAreThoseOfTheDefinitionAndBack)
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const double size : {1e-6, 1.0, 1e3, 1e9})
        for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{5e5, 5e6, 100}})
            for (int i = 0; i < 50; ++i) {
                if (size < 1e-3 && origin[0] != 0) continue;  // double does not resolve it there
                Camera camera;
                camera.modelview = product(translation({0, 0, -3 * size}), rotation(random));
                camera.projection = i % 2 ? perspective(0.6, size, 10 * size) : orthographic(2 * size, size, 10 * size);
                camera.width = 800;
                camera.height = 600;
                camera.origin = origin;
                const auto map = ScreenMap::of(camera);
                ASSERT_TRUE(map);
                const Vec3d p = origin + size * Vec3d{unit(random), unit(random), unit(random)};
                const auto place = map->place_of(p);
                ASSERT_TRUE(place);
                const auto expected = by_products(camera, p);
                for (std::size_t a = 0; a < 3; ++a)
                    EXPECT_NEAR((*place)[a], static_cast<double>(expected[a]), 1e-6) << size << " " << a;
                const Vec3d back = map->source_of(*place);
                EXPECT_LT(length(back - p), 1e-9 * size + 4e-9 * (origin[0] != 0 ? 1 : 0)) << size;
            }
}

TEST(ScreenMap, KeepsPartsOfSegmentsInThePicture)
{
    Camera camera;
    camera.modelview = translation({0, 0, -5});
    camera.projection = perspective(1, 0.1, 100);
    camera.width = camera.height = 100;
    const auto map = ScreenMap::of(camera);
    ASSERT_TRUE(map);
    const auto ends = [&](const Vec3d& a, const Vec3d& b) { return map->clipped(map->eye_of(a), map->eye_of(b), 0); };
    // The picture is 10 units wide at the origin.
    const auto across = ends({-1e9, 1, 0}, {1e9, 1, 0});
    ASSERT_TRUE(across);
    EXPECT_NEAR(across->first[0], -5, 1e-6);
    EXPECT_NEAR(across->second[0], 5, 1e-6);
    EXPECT_NEAR(across->first[1], 1, 1e-6);
    const auto towards = ends({0, 0, 0}, {0, 0, 100});
    ASSERT_TRUE(towards);
    EXPECT_NEAR(towards->second[2], -0.1, 1e-12) << "at the near plane";
    EXPECT_FALSE(ends({0, 0, 6}, {0, 1, 7})) << "behind the eye";
    EXPECT_FALSE(ends({20, 0, 0}, {20, 3, 0})) << "next to the picture";
    EXPECT_FALSE(ends({0, 0, std::numeric_limits<double>::quiet_NaN()}, {0, 0, 0}));
    EXPECT_FALSE(map->place_of({0, 0, 5}));
    EXPECT_FALSE(map->place_of({0, 0, 20}));
    EXPECT_NEAR(map->pixel_at({0, 0, -5}), 0.1, 1e-12);
}
