// Which points near a surface's continuation belong to it, against scenes whose truth is known.
#include "pcm/fit/local_support.h"

#include "pcm/fit/models/shape_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pcm {
namespace {

constexpr double noise = 0.004, threshold = 0.012;  // working units: coordinates are from -1 to 1

struct Scene {
    WorkingPoints points;
    std::size_t on = 0;  // the first points are of the surface, the others uniform in the cube
    void add(const Vec3d& p)
    {
        points.index.push_back(static_cast<std::uint32_t>(points.size()));
        points.x.push_back(p[0]);
        points.y.push_back(p[1]);
        points.z.push_back(p[2]);
    }
};

// A square of the plane z = height about (0.5, 0.5), and points of chance.
Scene square(std::size_t on, std::size_t others, double side, double height = 0)
{
    std::mt19937_64 random(on + 7 * others);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::normal_distribution<double> gauss;
    Scene scene;
    scene.on = on;
    for (std::size_t i = 0; i < on; ++i)
        scene.add({0.5 + side / 2 * unit(random), 0.5 + side / 2 * unit(random), height + noise * gauss(random)});
    for (std::size_t i = 0; i < others; ++i) scene.add({unit(random), unit(random), unit(random)});
    return scene;
}

Shape plane_at(double height) { return {ShapeKind::plane, {0, 0, height}, {0, 0, 1}, 0, 0}; }

LocalSupport support_of(const Scene& scene) { return {model_of(ShapeKind::plane), scene.points}; }

// Chance points in the plane's band are few next to the square's, and are left out wherever they are away from it.
TEST(LocalSupport, IsWhereMorePointsAreThanChanceBrings)
{
    for (const double height : {0.0, 0.7, -0.95})
        for (const std::size_t others : {4000u, 20000u, 200000u}) {
            const Scene scene = square(3000, others, 0.6, height);
            LocalSupport support = support_of(scene);
            ASSERT_TRUE(support.find(plane_at(height), threshold, noise));
            const double* const found = support.of_points();
            ASSERT_NE(found, nullptr);
            double on = 0, kept_on = 0, away = 0, kept_away = 0, kept = 0;
            for (std::size_t i = 0; i < scene.points.size(); ++i) {
                const Vec3d p = scene.points.at(i);
                const bool is_near = std::fabs(p[2] - height) <= threshold;
                ASSERT_TRUE(found[i] == 0 || found[i] == 1);
                if (!is_near) {
                    ASSERT_EQ(found[i], 0) << i;
                    continue;
                }
                kept += found[i];
                const double off = std::max(std::fabs(p[0] - 0.5), std::fabs(p[1] - 0.5));
                if (i < scene.on) ++on, kept_on += found[i];
                if (off > 0.5) ++away, kept_away += found[i];
            }
            ASSERT_GT(away, 25);  // or nothing is tested
            EXPECT_GT(kept_on, 0.995 * on);
            EXPECT_LT(kept_away, 0.1 * away + 1) << others;
            // Chance points in the band at the square: its area and the band's width of the cube's volume. They are
            // counted in blocks, to about a fifth of their number; the cube ends within the blocks at the last height.
            const double by_chance = static_cast<double>(others) * 0.36 * 2 * threshold / 8;
            if (height < 0 && others > 20000) continue;
            const double tolerance = 0.005 + 0.2 * by_chance / (on + by_chance);
            EXPECT_NEAR(support.share(), kept_on / kept, tolerance) << others;
            EXPECT_NEAR(support.share(), on / (on + by_chance), tolerance) << others;
        }
}

// Two surfaces in one plane both belong to the plane, however far apart.
TEST(LocalSupport, FollowsEveryPartOfTheSurface)
{
    Scene scene = square(2000, 6000, 0.5);
    for (std::size_t i = 0; i < 1000; ++i) {
        Vec3d p = scene.points.at(i);
        scene.add({p[0] - 1.2, p[1] - 1.2, p[2]});
    }
    LocalSupport support = support_of(scene);
    ASSERT_TRUE(support.find(plane_at(0), threshold, noise));
    ASSERT_NE(support.of_points(), nullptr);
    double on = 0, kept = 0;
    for (std::size_t i = 8000; i < 9000; ++i)
        if (std::fabs(scene.points.z[i]) <= threshold) ++on, kept += support.of_points()[i];
    ASSERT_GT(on, 950);
    EXPECT_GT(kept, 0.99 * on);
}

// A shape that moved by less than half the noise keeps what was found, to the last point.
TEST(LocalSupport, IsFoundAgainOnlyForAShapeThatMoved)
{
    const Scene scene = square(3000, 4000, 0.6);
    LocalSupport support = support_of(scene);
    ASSERT_TRUE(support.find(plane_at(0), threshold, noise));
    const std::vector<double> first(support.of_points(), support.of_points() + scene.points.size());
    const double share = support.share();
    for (const double moved : {0.0, 0.49}) {
        LocalSupport again = support;
        EXPECT_FALSE(again.find(plane_at(moved * noise), threshold, noise)) << moved;
        ASSERT_NE(again.of_points(), nullptr);
        EXPECT_TRUE(std::equal(first.begin(), first.end(), again.of_points())) << moved;
        EXPECT_EQ(again.share(), share);
    }
    for (const double moved : {-0.51, 0.51, 5.0}) {
        LocalSupport again = support;
        EXPECT_TRUE(again.find(plane_at(moved * noise), threshold, noise)) << moved;
        ASSERT_NE(again.of_points(), nullptr);
        EXPECT_FALSE(std::equal(first.begin(), first.end(), again.of_points())) << moved;
    }
}

// The support is undetermined for fewer than 50 points, for a scene without other points, and where the threshold is
// wide relative to the scene; what was found before is forgotten then.
TEST(LocalSupport, IsOfAllPointsWhereItIsUndetermined)
{
    const auto is_of_all = [](const Scene& scene, double height, double within) {
        LocalSupport support = support_of(scene);
        EXPECT_TRUE(support.find(plane_at(height), within, noise));
        if (!support.of_points()) EXPECT_EQ(support.share(), 1);
        return support.of_points() == nullptr;
    };
    const Scene scene = square(3000, 4000, 0.6);
    EXPECT_FALSE(is_of_all(scene, 0, 0.099));
    EXPECT_TRUE(is_of_all(scene, 0, 0.1));
    Scene few;
    for (std::size_t i = 0; i < 49; ++i)
        few.add({0.01 * static_cast<double>(i % 7), 0.01 * static_cast<double>(i / 7), 0});
    few.add({0, 0, 0.5});
    EXPECT_TRUE(is_of_all(few, 0, threshold));
    few.add({0.03, 0.03, 0});
    EXPECT_FALSE(is_of_all(few, 0, threshold));
    Scene alone = square(400, 0, 0.6);
    EXPECT_TRUE(is_of_all(alone, 0, 0.09));
    alone.add({0, 0, 0.5});
    EXPECT_FALSE(is_of_all(alone, 0, 0.09));

    LocalSupport support = support_of(scene);
    ASSERT_TRUE(support.find(plane_at(0), threshold, noise));
    ASSERT_NE(support.of_points(), nullptr);
    EXPECT_LT(support.share(), 1);
    ASSERT_TRUE(support.find(plane_at(5), threshold, noise));  // beyond all points
    EXPECT_EQ(support.of_points(), nullptr);
    EXPECT_EQ(support.share(), 1);
}

}  // namespace
}  // namespace pcm
