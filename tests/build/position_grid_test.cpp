// The grid of a new tree: steps at the borders of what a tree holds.
#include "pcm/build/bins/position_grid.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <cmath>
#include <limits>

namespace pcm {
namespace {

const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

double above(double value) { return std::nextafter(value, infinity); }
double below(double value) { return std::nextafter(value, -infinity); }

Box3d box_to(const Vec3d& corner)
{
    Box3d box;
    box.extend(Vec3d{0, 0, 0});
    box.extend(corner);
    return box;
}

TEST(PositionGrid, StepsAreThe61stPowerBelowTheLargestCoordinate)
{
    for (int e = -429; e <= 500; ++e) {
        const double power = std::ldexp(1.0, e);
        ASSERT_EQ(power_of_two_step(below(power)), std::ldexp(1.0, e - 61)) << e;
        ASSERT_EQ(power_of_two_step(power), std::ldexp(1.0, e - 60)) << e;
    }
    EXPECT_EQ(power_of_two_step(0x1p-430), 0x1p-490);
    for (const double small : {below(0x1p-430), 0x1p-431, below(0x1p-431), 0x1p-432, 0x1p-1000, 5e-324})
        EXPECT_EQ(power_of_two_step(small), 0x1p-491) << small;
    EXPECT_EQ(power_of_two_step(0), 0x1p-61);
}

// Each axis has a step of its own, but none finer than 2^-40 of the largest needs.
TEST(PositionGrid, AxesHaveStepsOfTheirOwn)
{
    const Grid grid = power_of_two_grid(box_to({-1000, 3, 1e-30}));
    EXPECT_EQ(grid.scale, (Vec3d{0x1p-51, 0x1p-59, power_of_two_step(1000 * 0x1p-40)}));
    EXPECT_EQ(grid.offset, (Vec3d{0, 0, 0}));
    EXPECT_EQ(power_of_two_grid(box_to({0, 0, 5})).scale[0], power_of_two_step(5 * 0x1p-40));
    EXPECT_EQ(power_of_two_grid(box_to({0, -5, 0})).scale[1], 0x1p-58);
    EXPECT_EQ(power_of_two_grid(Box3d()).scale, (Vec3d{0x1p-61, 0x1p-61, 0x1p-61}));
}

// A grid of the source resolves coordinates of at most 2^50 steps, its offset included.
TEST(PositionGrid, ResolvesUpTo50Bits)
{
    for (std::size_t a = 0; a < 3; ++a)
        for (const double scale : {1.0, -0.001, 1e-9, 7.0})
            for (const double side : {1.0, -1.0}) {
                const auto resolved = [&](double steps, double offset) {
                    Grid grid{{1e3, 1e3, 1e3}, {0, 0, 0}};
                    grid.scale[a] = scale;
                    grid.offset[a] = offset * std::fabs(scale);
                    Vec3d corner{1, 1, 1};
                    corner[a] = side * steps * std::fabs(scale);
                    return resolves(grid, box_to(corner));
                };
                EXPECT_TRUE(resolved(0x1p50 * (1 - 1e-12), 0));
                EXPECT_FALSE(resolved(0x1p50 * (1 + 1e-12), 0));
                EXPECT_TRUE(resolved(0x1p49, 0x1p49 * (1 - 1e-12)));
                EXPECT_FALSE(resolved(0x1p49, -0x1p49 * (1 + 1e-12)));
            }
    EXPECT_TRUE(resolves({{1, 1, 1}, {0, 0, 0}}, box_to({0x1p50, 0x1p50, -0x1p50})));
    EXPECT_FALSE(resolves({{1, 1, 1}, {0, 0, 0}}, box_to({nan, 0, infinity})));
    EXPECT_TRUE(resolves({{1, 1, 1}, {0, 0, 0}}, Box3d()));
}

TEST(PositionGrid, GridsThatATreeCannotHoldAreRefused)
{
    const auto refused = [](double scale, double offset) {
        std::size_t refusals = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            Grid grid{{0.01, 0.01, 0.01}, {1, 2, 3}};
            grid.scale[a] = scale;
            grid.offset[a] = offset;
            try {
                check_tree_grid(grid);
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
                EXPECT_NE(std::string(error.what()).find(std::string("the ") + "xyz"[a] + " coord"), std::string::npos)
                    << error.what();
                ++refusals;
            }
        }
        EXPECT_EQ(refusals % 3, 0u) << scale << " " << offset;
        return refusals > 0;
    };
    for (const double sign : {1.0, -1.0}) {
        EXPECT_FALSE(refused(sign * 0x1p-491, 0));
        EXPECT_TRUE(refused(sign * below(0x1p-491), 0));
        EXPECT_FALSE(refused(sign * 0x1p467, 0));  // 2^33 steps: 32 bits and the sign
        EXPECT_TRUE(refused(sign * above(0x1p467), 0));
        EXPECT_FALSE(refused(1, sign * 0x1p500));
        EXPECT_TRUE(refused(1, sign * above(0x1p500)));
    }
    for (const double bad : {0.0, nan, infinity}) EXPECT_TRUE(refused(bad, 0)) << bad;
    for (const double bad : {nan, -infinity}) EXPECT_TRUE(refused(1, bad)) << bad;
}

TEST(PositionGrid, PositionsThatATreeCannotHoldAreRefused)
{
    const auto refused = [](const Vec3d& a, const Vec3d& b, const char* says) {
        FarPoints points;
        points.watch(a);
        points.watch(b);
        try {
            check_tree_positions(points);
            return false;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
            return true;
        }
    };
    const char* const close = "the points are about";
    // The distance of two points counts over the root of 2; it is to be four steps of 2^-491.
    EXPECT_TRUE(refused({0, 0, 0}, {0, 5.6 * 0x1p-491, 0}, close));
    EXPECT_FALSE(refused({0, 0, 0}, {0, 5.7 * 0x1p-491, 0}, close));
    EXPECT_FALSE(refused({0x1p-600, 0, 0}, {0x1p-600, 0, 0}, close));  // at one place
    EXPECT_FALSE(refused({0, 0, 0}, {0, 0, 0}, close));
    const char* const large = "a tree holds coordinates up to";
    for (const double sign : {1.0, -1.0}) {
        const double most = sign * 0x1p500, more = sign * above(0x1p500);
        EXPECT_FALSE(refused({most, most, 0}, {0, 0, most}, large));
        EXPECT_TRUE(refused({more, more, 0}, {more, 0, 0}, large));
        EXPECT_TRUE(refused({0, 0, more}, {0, more, more}, large));
    }
}

}  // namespace
}  // namespace pcm
