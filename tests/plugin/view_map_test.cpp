// Pixels of a view and places of its scene.
#include "plugin/scene/view_map.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/tools/select/screen_shape.h"
#include "tests/plugin/cameras.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace pcm;
using namespace pcm::host;

namespace {

TEST(ViewMap, PixelsAndPlacesAreInverseAtMapCoordinates)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(0, 800), y(0, 600), far(2, 50);
    for (const bool parallel : {false, true})
        for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{500000, 4800000, 100}}) {
            const ViewMap view(test::camera_at(origin, parallel), 1);
            for (int i = 0; i < 1000; ++i) {
                const QPointF pixel(x(random), y(random));
                const SceneRay ray = view.ray(pixel);
                for (const Vec3d& place : {view.place_at(pixel), ray.from + far(random) * ray.direction}) {
                    const auto back = view.pixel_of(place);
                    ASSERT_TRUE(back);
                    // A step of double at 4.8e6 is 1e-9 units, of which a pixel here has about 1/100 at least.
                    ASSERT_NEAR(back->x(), pixel.x(), 1e-6);
                    ASSERT_NEAR(back->y(), pixel.y(), 1e-6);
                }
                ASSERT_NEAR(length(ray.direction), 1, 1e-14);
                ASSERT_LT(dot(ray.direction, view.back()), 0);
            }
        }
}

TEST(ViewMap, APlaceBehindTheEyeHasNoPixel)
{
    const ViewMap view(test::camera_at({0, 0, 0}, false), 1);
    const SceneRay ray = view.ray({400, 300});
    EXPECT_TRUE(view.pixel_of(ray.from + ray.direction));
    EXPECT_FALSE(view.pixel_of(ray.from - ray.direction));
}

TEST(ViewMap, APixelIsAsLargeAsTheStepToTheNextOne)
{
    for (const bool parallel : {false, true}) {
        const ViewMap view(test::camera_at({1000, 2000, 30}, parallel), 2);  // two of the screen to one of Qt's
        const SceneRay a = view.ray({200, 150}), b = view.ray({200, 151});
        const Vec3d place = a.from + 10 / -dot(a.direction, view.back()) * a.direction;
        const Vec3d next = b.from + 10 / -dot(b.direction, view.back()) * b.direction;
        EXPECT_NEAR(view.pixel_size(place), length(next - place), 1e-9);
    }
}

TEST(ViewMap, RefusesACameraThatShowsNothing)
{
    Camera camera = test::camera_at({0, 0, 0}, false);
    camera.width = 0;
    EXPECT_THROW(ViewMap(camera, 1), Error);
    camera = test::camera_at({0, 0, 0}, false);
    camera.modelview = Matrix4d{};
    EXPECT_THROW(ViewMap(camera, 1), Error);
}

// A shape on the screen, tested by projecting points, for a cloud that a matrix turns, scales and moves.
TEST(ScreenShape, ARegionHasThePointsThatAppearInTheShape)
{
    const Vec3d origin{500000, 4800000, 100};
    const ViewMap view(test::camera_at(origin, false), 1);
    Affine placement = Affine::rotation({0.2, 0.3, 1}, 0.7, origin + Vec3d{700, -300, 20}, 2.5);
    placement.target = origin + Vec3d{1, -2, 0.5};
    const ScreenShape shape{{200, 150}, {600, 200}, {400, 300}, {580, 480}, {220, 450}};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> anywhere(-4, 4);
    for (const auto& moved : {std::optional<Affine>(), std::optional<Affine>(placement)}) {
        const Region region = region_of(shape, view, moved);
        int in = 0, out = 0;
        for (int i = 0; i < 20000; ++i) {
            const Vec3d p =
                (moved ? moved->pivot : origin) + Vec3d{anywhere(random), anywhere(random), anywhere(random)};
            const auto pixel = view.pixel_of(moved ? (*moved)(p) : p);
            bool expected = false;
            for (std::size_t k = 0; pixel && k < shape.size(); ++k) {
                const QPointF a = shape[k], b = shape[(k + 1) % shape.size()];
                if ((a.y() > pixel->y()) != (b.y() > pixel->y()) &&
                    pixel->x() < a.x() + (pixel->y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
                    expected = !expected;
            }
            ASSERT_EQ(region.contains(p), expected) << i;
            ++(expected ? in : out);
        }
        EXPECT_GT(in, 500);
        EXPECT_GT(out, 500);
    }
}

TEST(ScreenShape, ShapesWithoutAreaAreRefused)
{
    const ViewMap view(test::camera_at({0, 0, 0}, false), 1);
    EXPECT_THROW(region_of({{10, 10}, {20, 20}}, view, {}), Error);
    EXPECT_THROW(region_of({{10, 10}, {20, 10}, {30, 10.5}}, view, {}), Error);
    EXPECT_NO_THROW(region_of(rectangle_of({10, 10}, {20, 30}), view, {}));
}

TEST(ScreenShape, ACircleHasItsRadius)
{
    const QPointF centre(120.5, 80);
    const ScreenShape circle = circle_of(centre, 15);
    EXPECT_LT(15 * (1 - std::cos(pi / double(circle.size()))), 0.26);  // pixels off the circle
    QPointF middle;
    for (const QPointF& corner : circle) {
        EXPECT_NEAR(std::hypot(corner.x() - centre.x(), corner.y() - centre.y()), 15, 1e-12);
        middle += corner / double(circle.size());
    }
    EXPECT_NEAR(middle.x(), centre.x(), 1e-9);
    EXPECT_NEAR(middle.y(), centre.y(), 1e-9);
}

TEST(ScreenShape, ABallMovesWithItsCloud)
{
    const Vec3d origin{500000, 4800000, 100};
    Affine placement = Affine::rotation({0, 1, 1}, 1.1, origin, 4);
    placement.target = {10, 20, 30};
    const Vec3d place = origin + Vec3d{3, 4, 5};
    const auto ball = ball_in({placement(place), 2}, placement);
    ASSERT_TRUE(ball);
    EXPECT_LT(length(ball->centre - place), 1e-8);
    EXPECT_NEAR(ball->radius, 0.5, 1e-12);
    placement.linear[0] = {0, 0, 0};
    EXPECT_FALSE(ball_in({place, 2}, placement));
}

}  // namespace
