// Where the radius of a pipe changes, of pipes that are seen from one side.
#include "pcm/place/radius_step.h"

#include "pcm/cloud/numbers.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double stepped_noise = 0.0015;
constexpr double stepped_length = 2;
constexpr Vec3d stepped_middle{456780, 5432100, 120};

class RadiusStepTest : public testing::Test {
protected:
    // A pipe about the axis through the middle, of the radius at each way, of which less than half around is seen.
    std::vector<Vec3d> pipe(const std::function<double(double)>& radius_at, int count = 4000)
    {
        const auto [u, v] = across(cylinder_.axis);
        std::vector<Vec3d> points;
        for (int i = 0; i < count; ++i) {
            const double way = stepped_length * dice_.between(-0.5, 0.5), angle = dice_.between(-1.4, 1.4);
            const double away = radius_at(way) + stepped_noise * dice_.normal();
            points.push_back(stepped_middle + way * cylinder_.axis +
                             away * (std::cos(angle) * u + std::sin(angle) * v));
        }
        return points;
    }
    Vec3d at(double way) const { return stepped_middle + way * cylinder_.axis + Vec3d{0.02, 0.01, 0}; }
    std::optional<RadiusStep> step(const std::vector<Vec3d>& points, double way, double least = 0.002) const
    {
        return radius_step(cylinder_, stepped_noise, least, at(way), points);
    }

    Dice dice_{11};
    pcm::Shape cylinder_{ShapeKind::cylinder, stepped_middle, normalised(Vec3d{0.3, -0.2, 0.9}), 0.037, 0};
};

TEST_F(RadiusStepTest, APipeBehindAReducerIsFoundFromBothSides)
{
    const std::vector<Vec3d> points = pipe([](double way) { return way < 0.25 ? 0.04 : 0.034; });
    const auto of_wide = step(points, -0.2);
    ASSERT_TRUE(of_wide);
    EXPECT_TRUE(of_wide->has_place);
    EXPECT_EQ(of_wide->from, -infinity);
    EXPECT_LT(of_wide->to, 0.25 - 0.5 * stepped_length / 40) << "without the slice next to the step";
    EXPECT_GT(of_wide->to, 0.25 - 3 * stepped_length / 40);
    EXPECT_NEAR(of_wide->radius, 0.04, 0.0005);
    EXPECT_NEAR(of_wide->beyond, 0.034, 0.0005);
    const auto of_narrow = step(points, 0.6);
    ASSERT_TRUE(of_narrow);
    EXPECT_TRUE(of_narrow->has_place);
    EXPECT_EQ(of_narrow->to, infinity);
    EXPECT_GT(of_narrow->from, 0.25 + 0.5 * stepped_length / 40);
    EXPECT_LT(of_narrow->from, 0.25 + 3 * stepped_length / 40);
    EXPECT_NEAR(of_narrow->radius, 0.034, 0.0005);
    EXPECT_NEAR(of_narrow->beyond, 0.04, 0.0005);
    const auto of_step = step(points, 0.25);
    ASSERT_TRUE(of_step);
    EXPECT_FALSE(of_step->has_place);
}

TEST_F(RadiusStepTest, APieceBetweenTwoReducersHasTwoEnds)
{
    const std::vector<Vec3d> points = pipe([](double way) { return std::fabs(way) < 0.3 ? 0.03 : 0.04; });
    const auto found = step(points, 0.1);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->has_place);
    EXPECT_NEAR(found->from, -0.3, 2 * stepped_length / 40);
    EXPECT_NEAR(found->to, 0.3, 2 * stepped_length / 40);
    EXPECT_GE(found->from, -0.3);
    EXPECT_LE(found->to, 0.3);
    EXPECT_NEAR(found->radius, 0.03, 0.0005);
}

TEST_F(RadiusStepTest, OnePipeHasNone)
{
    for (int round = 0; round < 20; ++round) {
        const std::vector<Vec3d> points = pipe([](double) { return 0.037; });
        EXPECT_FALSE(step(points, dice_.between(-0.9, 0.9), 0));
    }
}

// The step of least squares explains three quarters of it.
TEST_F(RadiusStepTest, AConeHasNone)
{
    for (const double way : {-0.8, 0.1, 0.6})
        EXPECT_FALSE(step(pipe([](double along) { return 0.037 + 0.006 * along; }), way)) << way;
}

TEST_F(RadiusStepTest, StepsBelowTheLeastAndThoseOfFewPointsAreNone)
{
    const auto reducer = [](double way) { return way < 0.25 ? 0.04 : 0.034; };
    EXPECT_TRUE(step(pipe(reducer), -0.2, 0.005));
    EXPECT_FALSE(step(pipe(reducer), -0.2, 0.007));
    EXPECT_FALSE(step(pipe(reducer, 100), -0.2));
    EXPECT_FALSE(step({}, -0.2));
    EXPECT_FALSE(radius_step(cylinder_, 0, 0.002, at(-0.2), pipe(reducer)));
    EXPECT_FALSE(step(pipe(reducer), 1.5)) << "beyond its end";
}

// A slice of which too little is seen has no radius, whatever circle fits it best.
TEST_F(RadiusStepTest, SlicesOfSmallArcsCountLittle)
{
    std::vector<Vec3d> points = pipe([](double) { return 0.037; });
    const auto [u, v] = across(cylinder_.axis);
    points.erase(std::remove_if(points.begin(), points.end(),
                                [&](const Vec3d& p) {
                                    const Vec3d d = p - stepped_middle;
                                    return dot(d, cylinder_.axis) > 0.2 && std::fabs(dot(d, v)) > 0.12 * dot(d, u);
                                }),
                 points.end());
    EXPECT_FALSE(step(points, -0.2, 0));
    EXPECT_FALSE(step(points, 0.5, 0));
}

}  // namespace
