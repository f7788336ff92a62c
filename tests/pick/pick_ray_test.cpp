// Rays of pixels against projection in long double, for cameras at map coordinates with near planes of a millionth of
// the scene.
#include "pcm/pick/pick_ray.h"

#include "pcm/system/error.h"
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

using Long = long double;
using Long3 = std::array<Long, 3>;

// Clip coordinates of a place relative to the camera's origin.
std::array<Long, 4> clip_of(const Camera& camera, const Long3& local)
{
    const auto apply = [](const Matrix4d& m, const std::array<Long, 4>& v) {
        std::array<Long, 4> r{};
        for (std::size_t row = 0; row < 4; ++row)
            for (std::size_t column = 0; column < 4; ++column) r[row] += Long(m[column * 4 + row]) * v[column];
        return r;
    };
    return apply(camera.projection, apply(camera.modelview, {local[0], local[1], local[2], 1}));
}

Long3 place_at(const PickRay& ray, const Camera& camera, double t)
{
    Long3 p{};
    for (std::size_t a = 0; a < 3; ++a)
        p[a] = (Long(ray.centre[a]) - Long(camera.origin[a])) + Long(ray.start[a]) + Long(t) * Long(ray.direction[a]);
    return p;
}

struct Pixels {
    Long x, y;
};
Pixels pixels_of(const Camera& camera, const Long3& p)
{
    const auto c = clip_of(camera, p);
    return {(c[0] / c[3] + 1) / 2 * camera.width, (1 - c[1] / c[3]) / 2 * camera.height};
}

TEST(PickRay, GoesThroughItsPixelFromTheNearToTheFarPlane)
{
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    int perspectives = 0, parallels = 0, near_ends = 0, far_ends = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d map = i % 2 ? Vec3d{5e6, 4.8e6, 100} : Vec3d{0, 0, 0};
        const Vec3d eye{map[0] + 50 * unit(random), map[1] + 50 * unit(random), map[2] + 50 * unit(random)};
        const Camera camera = random_view(random, eye, map, 100);
        const double x = camera.width * unit(random), y = camera.height * unit(random);
        const auto ray = PickRay::through(camera, x, y);
        ASSERT_TRUE(ray) << i;
        const bool parallel = camera.projection[15] != 0;
        (parallel ? parallels : perspectives)++;
        EXPECT_NEAR(dot(ray->direction, ray->direction), 1, 1e-14);
        ASSERT_LT(ray->begin, ray->end);
        if (parallel) EXPECT_EQ(ray->begin, 0);
        // The eye is known to an epsilon of its distance from the camera's origin, and nothing on the ray better.
        const double rounding = 1e-13 * (length(ray->start) + length(eye - camera.origin));
        for (const double share : {0.0, 0.001, 0.5, 1.0}) {
            const double end = std::isfinite(ray->end) ? ray->end : ray->begin + 1000;
            const double t = ray->begin + share * (end - ray->begin);
            const double pixel = ray->pixel_at(t);
            ASSERT_GT(pixel, 0);
            const Pixels at = pixels_of(camera, place_at(*ray, camera, t));
            const double allowed = 1e-7 + (4 * rounding + 1e-15 * t) / pixel;  // a direction has an epsilon
            EXPECT_NEAR(static_cast<double>(at.x), x, allowed) << i << " " << share;
            EXPECT_NEAR(static_cast<double>(at.y), y, allowed) << i << " " << share;
        }
        const auto near = clip_of(camera, place_at(*ray, camera, ray->begin));
        if (rounding < 1e-6 * ray->begin || parallel) {
            EXPECT_NEAR(static_cast<double>(near[2] / near[3]), -1, 1e-5) << i;
            ++near_ends;
        }
        const double slope = camera.projection[10] + 1;
        if (parallel || std::fabs(slope) > 1e-6) {  // else the far plane drowns in rounding, and ends nothing
            const auto far = clip_of(camera, place_at(*ray, camera, ray->end));
            EXPECT_NEAR(static_cast<double>(far[2] / far[3]), 1, 1e-6) << i;
            ++far_ends;
        }
    }
    EXPECT_GT(perspectives, 500);
    EXPECT_GT(parallels, 500);
    EXPECT_GT(near_ends, 1000);
    EXPECT_GT(far_ends, 700);
}

// A step of pixel_at(t) along a row of the picture is one pixel.
TEST(PickRay, KnowsTheSizeOfAPixel)
{
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 1000; ++i) {
        const Camera camera = random_view(random, {3, 4, 5}, {0, 0, 0}, 100);
        const double x = camera.width * unit(random), y = camera.height * unit(random);
        const auto ray = PickRay::through(camera, x, y), beside = PickRay::through(camera, x, y + 1);
        ASSERT_TRUE(ray && beside);
        const double t = std::max(ray->begin, 1.0);
        const Long3 p = place_at(*ray, camera, t);
        // Down the picture, in source axes: the row of the modelview.
        const Matrix4d& m = camera.modelview;
        const double scale = std::sqrt(m[1] * m[1] + m[5] * m[5] + m[9] * m[9]);
        Long3 moved = p;
        for (std::size_t a = 0; a < 3; ++a) moved[a] -= Long(ray->pixel_at(t)) * m[4 * a + 1] / scale;
        const Pixels before = pixels_of(camera, p), after = pixels_of(camera, moved);
        EXPECT_NEAR(static_cast<double>(after.y - before.y), 1, 1e-6) << i;
        EXPECT_NEAR(static_cast<double>(after.x - before.x), 0, 1e-6) << i;
    }
}

TEST(PickRay, YGrowsDownwards)
{
    Camera camera;
    camera.modelview = identity();
    camera.projection = perspective(-1, 1, -1, 1, 1, 10);
    camera.width = camera.height = 100;
    const auto ray = PickRay::through(camera, 100, 0);
    ASSERT_TRUE(ray);
    EXPECT_NEAR(ray->direction[0], 1 / std::sqrt(3), 1e-15);
    EXPECT_NEAR(ray->direction[1], 1 / std::sqrt(3), 1e-15);
    EXPECT_NEAR(ray->direction[2], -1 / std::sqrt(3), 1e-15);
    EXPECT_NEAR(ray->begin, std::sqrt(3), 1e-14);
    EXPECT_NEAR(ray->end, 10 * std::sqrt(3), 1e-13);
}

// What a placement moves to the ray is where the ray's image is; lengths are those of the cloud.
TEST(PickRay, IsSeenByAMovedCloud)
{
    std::mt19937_64 random(13);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 500; ++i) {
        const Vec3d map{5e6, 4.8e6, 100};
        const Camera camera = random_view(random, map + Vec3d{3, 4, 5}, map, 100);
        auto ray = PickRay::through(camera, camera.width * unit(random), camera.height * unit(random));
        ASSERT_TRUE(ray);
        ray->end = ray->begin + 50;
        const double scale = std::pow(10.0, 4 * unit(random) - 2);
        Affine placement = Affine::rotation({unit(random), unit(random), 0.1}, unit(random), map, scale);
        placement.target = placement.target + Vec3d{10, -20, 3};
        const auto own = ray->before(placement);
        ASSERT_TRUE(own);
        EXPECT_NEAR(own->scale, 1 / scale, 1e-12 / scale);
        EXPECT_NEAR(dot(own->direction, own->direction), 1, 1e-14);
        for (const double t : {ray->begin, ray->end}) {
            const Vec3d p = own->centre + (own->start + t * own->scale * own->direction);
            const Vec3d seen = placement(p), there = ray->centre + (ray->start + t * ray->direction);
            EXPECT_LT(length(seen - there), 1e-7) << i;
            EXPECT_NEAR(own->pixel_at(t * own->scale) / own->scale, ray->pixel_at(t), 1e-9 * ray->pixel_at(t));
        }
        EXPECT_NEAR(own->begin, ray->begin / scale, 1e-9 * own->begin);
        EXPECT_NEAR(own->end, ray->end / scale, 1e-9 * own->end);
    }
    Affine flat;
    flat.linear[2] = flat.linear[1];
    EXPECT_FALSE(PickRay::along({0, 0, 0}, {1, 0, 0}, 0, 1).before(flat));
}

TEST(PickRay, RefusesWhatIsNoRay)
{
    Camera camera;
    camera.modelview = identity();
    camera.projection = perspective(-1, 1, -1, 1, 1, 10);
    camera.width = camera.height = 100;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(PickRay::through(camera, nan, 0));
    Camera broken = camera;
    broken.width = 0;
    EXPECT_FALSE(PickRay::through(broken, 1, 1));
    broken = camera;
    broken.modelview[0] = 0;  // flat
    EXPECT_FALSE(PickRay::through(broken, 1, 1));
    EXPECT_THROW(PickRay::along({0, 0, 0}, {0, 0, 0}, 0, 1), Error);
    EXPECT_THROW(PickRay::along({nan, 0, 0}, {0, 0, 1}, 0, 1), Error);
    EXPECT_THROW(PickRay::along({0, 0, 0}, {0, 0, 1}, -1, 1), Error);
}

}  // namespace
