// The numbers of a view that splats' shaders take, against projection by plain matrix products.
#include "pcm/gl/draw/splat_camera.h"

#include "tests/support.h"
#include "tests/view/random_views.h"

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr int left = 13, bottom = 7;  // corner of the viewport

struct Window {
    double x, y, depth;  // pixels; the window's depth, not reversed
};

Window window_of(const Camera& view, const Vec3d& local)
{
    const auto c = clip(view, local + view.origin);
    return {left + (c[0] / c[3] + 1) / 2 * view.width, bottom + (c[1] / c[3] + 1) / 2 * view.height,
            (c[2] / c[3] + 1) / 2};
}

// Views, each also with its matrices multiplied by numbers that change nothing.
template <class Check>
void for_views(int count, const Check& check)
{
    std::mt19937_64 random(11);
    for (int i = 0; i < count; ++i) {
        const Vec3d origin{100, -30, 8};
        Camera view = random_view(random, origin + Vec3d{1, 2, 3}, origin, 20);
        if (i % 3 == 1) {
            for (double& v : view.modelview) v *= 2.5;
            for (double& v : view.projection) v *= 0.25;
        }
        if (i % 3 == 2)  // squeezed along the source's x
            for (std::size_t r = 0; r < 3; ++r) view.modelview[r] *= 0.4;
        for (const bool reversed : {false, true}) {
            SCOPED_TRACE(std::to_string(i) + (reversed ? " reversed" : ""));
            const auto camera = SplatCamera::of(view, left, bottom, reversed);
            ASSERT_TRUE(camera);
            check(view, *camera, reversed, random);
        }
    }
}

// A place in front of the eye, in the picture or next to it, relative to the view's origin.
Vec3d random_place(const SplatCamera& camera, std::mt19937_64& random)
{
    std::uniform_real_distribution<double> unit(-1, 1);
    for (;;) {
        const Vec3d place{40 * unit(random), 40 * unit(random), 40 * unit(random)};
        if (camera.orthographic || camera.eye_of(place)[2] < -1e-3 * camera.scale) return place;
    }
}

TEST(SplatCameras, ProjectAsTheViewDoes)
{
    for_views(60, [](const Camera& view, const SplatCamera& camera, bool reversed, std::mt19937_64& random) {
        for (int k = 0; k < 30; ++k) {
            const Vec3d place = random_place(camera, random), eye = camera.eye_of(place);
            const Window expected = window_of(view, place);
            const double depth = -eye[2], by = camera.orthographic ? 1 : 1 / depth;
            const double size = 1 + std::abs(expected.x) + std::abs(expected.y);
            EXPECT_NEAR(camera.principal[0] + camera.focal[0] * eye[0] * by, expected.x, 1e-9 * size);
            EXPECT_NEAR(camera.principal[1] + camera.focal[1] * eye[1] * by, expected.y, 1e-9 * size);
            const double z = camera.depth_of[0] + camera.depth_of[1] * (camera.orthographic ? depth : 1 / depth);
            EXPECT_NEAR(z, reversed ? 1 - expected.depth : expected.depth, 1e-9 * (1 + std::abs(expected.depth)));
            // The matrix for shaders, in single precision.
            double c[4] = {};
            for (std::size_t r = 0; r < 4; ++r)
                for (std::size_t a = 0; a < 4; ++a)
                    c[r] += static_cast<double>(camera.projection[a * 4 + r]) * (a < 3 ? eye[a] : 1);
            const double w = camera.orthographic ? 1 : depth;
            EXPECT_NEAR(c[3] / w, 1, 1e-6);
            EXPECT_NEAR(left + (c[0] / c[3] + 1) / 2 * view.width, expected.x, 1e-5 * size);
            EXPECT_NEAR(bottom + (c[1] / c[3] + 1) / 2 * view.height, expected.y, 1e-5 * size);
            const double ndc = 2 * expected.depth - 1;
            EXPECT_NEAR(c[2] / c[3], reversed ? (1 - ndc) / 2 : ndc, 1e-5 * (1 + std::abs(ndc)));
            const auto exact = clip(view, place + view.origin);
            const double sign = exact[3] < 0 ? -1 : 1;
            EXPECT_EQ(camera.is_in_view(place),
                      std::abs(exact[0]) <= sign * exact[3] && std::abs(exact[1]) <= sign * exact[3]);
        }
    });
}

TEST(SplatCameras, KnowThePixelsDirectionsAndTheEye)
{
    for_views(60, [](const Camera& view, const SplatCamera& camera, bool, std::mt19937_64& random) {
        const Vec3d place = random_place(camera, random);
        const double depth = camera.orthographic ? 1 : -camera.eye_of(place)[2];
        const Window at = window_of(view, place), right = window_of(view, place + depth * camera.pixel_x),
                     up = window_of(view, place + depth * camera.pixel_y);
        const double close = 1e-8 * (1 + std::abs(at.x) + std::abs(at.y));
        EXPECT_NEAR(right.x - at.x, 1, close);
        EXPECT_NEAR(right.y - at.y, 0, close);
        EXPECT_NEAR(up.x - at.x, 0, close);
        EXPECT_NEAR(up.y - at.y, 1, close);
        EXPECT_EQ(camera.centre_pixel[0], left + 640.5);
        EXPECT_EQ(camera.centre_pixel[1], bottom + 360.5);
        if (!camera.orthographic) {
            EXPECT_NEAR(length(camera.eye_of(camera.eye)) / camera.scale, 0, 1e-9);
            const Vec3d on_ray = camera.eye + 7 * camera.scale * camera.centre_ray;
            EXPECT_NEAR(window_of(view, on_ray).x, camera.centre_pixel[0], 1e-6);
            EXPECT_NEAR(window_of(view, on_ray).y, camera.centre_pixel[1], 1e-6);
            EXPECT_NEAR(-camera.eye_of(on_ray)[2] / (7 * camera.scale), 1, 1e-9) << "of depth 1";
        } else {
            const Window beside = window_of(view, place + 5.0 * camera.centre_ray);
            EXPECT_NEAR(beside.x, at.x, close);
            EXPECT_NEAR(beside.y, at.y, close);
            EXPECT_NEAR(camera.eye_of(place + 5.0 * camera.centre_ray)[2], camera.eye_of(place)[2] - 5, 1e-8);
        }
        EXPECT_EQ(camera.square_pixels(), 2 * camera.focal[1]);
        EXPECT_NEAR(camera.pixels_at(2 * camera.near + 3),
                    camera.scale * std::abs(camera.focal[1]) / (camera.orthographic ? 1 : 2 * camera.near + 3),
                    1e-12 * camera.scale * std::abs(camera.focal[1]));
    });
}

TEST(SplatCameras, ScalesBoundEveryDirection)
{
    for_views(60, [](const Camera&, const SplatCamera& camera, bool, std::mt19937_64& random) {
        std::normal_distribution<double> normal;
        const Vec3d zero = camera.eye_of({});
        double most = 0, least = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 300; ++k) {
            const Vec3d v = normalised(Vec3d{normal(random), normal(random), normal(random)});
            const Vec3d n{normal(random), normal(random), normal(random)};
            const Vec3d turned = camera.eye_of(v) - zero;
            most = std::max(most, length(turned));
            least = std::min(least, length(turned));
            Vec3d normal_there{};
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t a = 0; a < 3; ++a) normal_there[r] += camera.normal_to_eye[a * 3 + r] * n[a];
            EXPECT_NEAR(dot(normal_there, turned), dot(n, v), 1e-9) << "the inverse, transposed";
        }
        EXPECT_LE(most, camera.scale * (1 + 1e-9));
        EXPECT_GE(most, camera.scale / std::sqrt(3.0) * 0.99);
        EXPECT_LE(most / least, camera.squeeze * (1 + 1e-9));
        EXPECT_GE(camera.squeeze, 1 - 1e-9);
    });
}

// Limits for the splat of any point in a box in front of the near plane: its square, and the box around a sphere of its
// radius.
TEST(SplatCameras, BoundTheLargestSplats)
{
    int boxes = 0, tight = 0;
    for_views(120, [&](const Camera& view, const SplatCamera& camera, bool, std::mt19937_64& random) {
        std::uniform_real_distribution<double> unit(0, 1);
        Box3d box;
        box.min = random_place(camera, random);
        const double side = 3 * unit(random), radius = 0.3 * unit(random);
        box.max = box.min + Vec3d{side * unit(random), side * unit(random), side * unit(random)};
        const double square = camera.largest_square(box, radius), disc = camera.largest_box(box, radius);
        EXPECT_GE(square, 1);
        double largest = 1;
        for (int k = 0; k < 8; ++k) {  // the nearest point is a corner
            const Vec3d place{k & 1 ? box.max[0] : box.min[0], k & 2 ? box.max[1] : box.min[1],
                              k & 4 ? box.max[2] : box.min[2]};
            const double depth = std::max(-camera.eye_of(place)[2], camera.near);
            largest = std::max(largest, 2 * radius * camera.pixels_at(depth));
        }
        EXPECT_NEAR(square / largest, 1, 1e-9);
        EXPECT_LE(disc, 1280 + 4);
        EXPECT_LE(camera.largest_box_of(3), camera.largest_box_of(9));
        for (int k = 0; k < 20; ++k) {
            Vec3d place = box.min;
            for (std::size_t a = 0; a < 3; ++a) place[a] += unit(random) * box.extent(a);
            if (!camera.is_in_view(place) || -camera.eye_of(place)[2] < camera.near) continue;
            const Vec3d eye = camera.eye_of(place);
            const double r = radius * camera.scale;
            double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
            std::normal_distribution<double> normal;
            bool whole = true;
            for (int n = 0; n < 200; ++n) {
                const Vec3d q = eye + r * normalised(Vec3d{normal(random), normal(random), normal(random)});
                const double by = camera.orthographic ? 1 : 1 / -q[2];
                whole = whole && by > 0;
                for (std::size_t a = 0; a < 2; ++a) {
                    low[a] = std::min(low[a], camera.focal[a] * q[a] * by);
                    high[a] = std::max(high[a], camera.focal[a] * q[a] * by);
                }
            }
            if (!whole) continue;
            ++boxes;
            const double size = std::max(high[0] - low[0], high[1] - low[1]);
            EXPECT_GE(disc, std::min(size, double(view.width)));
            tight += disc < 4 * size + 8;
        }
    });
    EXPECT_GT(boxes, 300);
    EXPECT_GT(tight, boxes / 4) << "not by far too much";
}

TEST(SplatCameras, ThereIsNoneWithoutAView)
{
    Camera view;
    view.width = 1280;
    view.height = 720;
    view.modelview = identity();
    view.projection = {};
    EXPECT_FALSE(SplatCamera::of(view, 0, 0, false));
}

}  // namespace
