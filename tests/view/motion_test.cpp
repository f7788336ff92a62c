#include "pcm/view/motion.h"

#include "tests/support.h"

#include <cmath>
#include <limits>

namespace {

using namespace pcm;

// Rotated about z by `angle`, then moved.
Camera view_at(double angle, const Vec3d& move, double scale = 1)
{
    Camera view;
    view.modelview = {std::cos(angle) * scale,
                      std::sin(angle) * scale,
                      0,
                      0,
                      -std::sin(angle) * scale,
                      std::cos(angle) * scale,
                      0,
                      0,
                      0,
                      0,
                      scale,
                      0,
                      move[0],
                      move[1],
                      move[2],
                      1};
    view.projection[0] = view.projection[5] = 1;
    view.width = 640;
    view.height = 480;
    return view;
}

void expect_near(const Camera& a, const Camera& b)
{
    for (std::size_t i = 0; i < 16; ++i)
        EXPECT_NEAR(a.modelview[i], b.modelview[i], 1e-9 * (1 + std::fabs(b.modelview[i]))) << i;
}

TEST(Motion, TheMotionContinues)
{
    for (const unsigned frames : {1u, 2u, 8u, 30u}) {
        const double n = frames;
        // Forwards and sideways, turning, and coming nearer by scale.
        auto found = predict(view_at(0.3, {1, 2, -50}), view_at(0.3, {1.5, 2, -49}), frames);
        ASSERT_TRUE(found);
        expect_near(*found, view_at(0.3, {1.5 + 0.5 * n, 2, -49 + n}));
        found = predict(view_at(0.3, {0, 0, 0}), view_at(0.32, {0, 0, 0}), frames);
        ASSERT_TRUE(found);
        expect_near(*found, view_at(0.32 + 0.02 * n, {0, 0, 0}));
        found = predict(view_at(0, {0, 0, 0}, 1), view_at(0, {0, 0, 0}, 1.25), frames);
        ASSERT_TRUE(found);
        expect_near(*found, view_at(0, {0, 0, 0}, 1.25 * std::pow(1.25, n)));
        EXPECT_EQ(found->width, 640);
    }
    // A common factor of a matrix has no effect.
    Camera before = view_at(0, {0, 0, -5}), now = view_at(0, {0, 0, -4});
    for (double& v : before.modelview) v *= 2;
    for (double& v : now.modelview) v *= -3;
    const auto found = predict(before, now, 3);
    ASSERT_TRUE(found);
    expect_near(*found, view_at(0, {0, 0, -1}));
}

TEST(Motion, IsNotPredictedFromCamerasThatCannotBeCompared)
{
    const Camera view = view_at(0, {0, 0, -5}), moved = view_at(0, {0, 0, -4});
    EXPECT_FALSE(predict(view, view, 8));
    Camera other = moved;
    other.width = 641;
    EXPECT_FALSE(predict(view, other, 8));
    other = moved;
    other.origin = {1, 0, 0};
    EXPECT_FALSE(predict(view, other, 8));
    other = moved;
    other.projection[0] = 2;
    EXPECT_FALSE(predict(view, other, 8));
    for (const double bad : {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        other = moved;
        other.modelview[15] = bad;
        EXPECT_FALSE(predict(view, other, 8)) << bad;
        EXPECT_FALSE(predict(other, view, 8)) << bad;
    }
    other = moved;
    other.modelview[10] = 0;
    EXPECT_FALSE(predict(other, view, 8));
    EXPECT_FALSE(predict(view_at(0, {0, 0, 0}, 1), view_at(0, {0, 0, 0}, 1e30), 30));  // overflow
}

}  // namespace
