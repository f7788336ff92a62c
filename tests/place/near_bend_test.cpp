// Pipes that bend near a place, and pipes that do not.
#include "pcm/place/near_bend.h"

#include "pcm/place/grow_shape.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double noise = 0.0015;
constexpr Vec3d map{456780, 5432100, 120};

// A pipe along the axis up to its tangent, from which on an elbow bends it to one side; the half that a scanner sees.
class NearBendTest : public testing::Test {
protected:
    static constexpr double narrow = 0.084, wide = 0.252;

    NearBendTest()
    {
        pipe_.cylinder.kind = ShapeKind::cylinder;
        pipe_.cylinder.point = map;
        pipe_.cylinder.axis = normalised({0.3, -0.4, 1});
        pipe_.cylinder.radius = narrow;
        pipe_.threshold = 0.005;
        pipe_.noise = noise;
    }

    // `way`: from the tangent, against the direction of the pipe below 0; `along`: 1 or -1, the end that is bent.
    Vec3d on_pipe(double way, double turn, double along, double away = 0) const
    {
        const auto [u, v] = across(pipe_.cylinder.axis);
        const double angle = std::max(way, 0.0) / wide;
        const Vec3d ahead = along * pipe_.cylinder.axis;
        const Vec3d middle =
            map + std::min(way, 0.0) * ahead + wide * std::sin(angle) * ahead + wide * (1 - std::cos(angle)) * u;
        const Vec3d inwards = std::cos(angle) * u - std::sin(angle) * ahead;
        return middle + (narrow + away) * (std::cos(turn) * inwards + std::sin(turn) * v);
    }

    std::vector<Vec3d> points(int count, double last, double along = 1, double from = 0)
    {
        Dice dice(3);
        std::vector<Vec3d> all;
        for (int i = 0; i < count; ++i)
            all.push_back(on_pipe(dice.between(-0.6, last), from + dice.between(0, pi), along, noise * dice.normal()));
        return all;
    }

    std::optional<NearBend> bend_at(const std::vector<Vec3d>& points, double way, double along = 1)
    {
        pipe_.place = on_pipe(way, 1, along);
        return bend_near(pipe_, points);
    }

    PipeAtPlace pipe_;
};

TEST_F(NearBendTest, ItsBeginningAndRadiusAreFound)
{
    for (const double along : {1.0, -1.0})
        for (const double from : {0.0, 2.0, 4.0}) {
            const std::vector<Vec3d> seen = points(3000, 0.12, along, from);
            for (const double way : {-0.1, -0.06, 0.02}) {
                const auto bend = bend_at(seen, way, along);
                ASSERT_TRUE(bend) << way << " " << from;
                EXPECT_NEAR(bend->start, -way, 0.02);
                EXPECT_LE(bend->least_start, -way);
                EXPECT_GT(bend->least_start, -way - 0.05);
                EXPECT_NEAR(bend->radius, wide, 0.3 * wide);
                EXPECT_GT(bend->evidence, 50);
                EXPECT_NEAR(dot(bend->direction, along * pipe_.cylinder.axis), 1, 1e-9);
            }
        }
}

// The beginning is uncertain by the more the fewer points there are.
// Points around a cylinder end where the elbow has left it, but for those at its sides.
TEST_F(NearBendTest, AnElbowThatLeavesThePointsAroundIsFound)
{
    for (const double along : {1.0, -1.0})
        for (const double from : {0.0, 2.0, 4.0}) {
            std::vector<Vec3d> seen = points(4000, 0.35, along, from);
            const double around = around_thresholds * pipe_.threshold;
            const auto is_far = [&](const Vec3d& p) { return std::fabs(distance_to(pipe_.cylinder, p)) > around; };
            seen.erase(std::remove_if(seen.begin(), seen.end(), is_far), seen.end());
            for (const double way : {0.03, 0.07}) {
                SCOPED_TRACE(std::to_string(along) + " " + std::to_string(from) + " " + std::to_string(way));
                const auto bend = bend_at(seen, way, along);
                ASSERT_TRUE(bend);
                EXPECT_NEAR(bend->start, -way, 0.02);
                EXPECT_LT(bend->least_start, 0);
                EXPECT_NEAR(bend->radius, wide, 0.2 * wide);
                EXPECT_NEAR(dot(bend->direction, along * pipe_.cylinder.axis), 1, 1e-9);
            }
        }
}

TEST_F(NearBendTest, FewPointsLeaveItUncertain)
{
    const auto many = bend_at(points(8000, 0.12), -0.08), few = bend_at(points(700, 0.12), -0.08);
    ASSERT_TRUE(many && few);
    EXPECT_GT(many->start - many->least_start, 0);
    EXPECT_GT(few->start - few->least_start, many->start - many->least_start);
    EXPECT_GT(many->evidence, 5 * few->evidence);
    EXPECT_FALSE(bend_at(points(70, 0.12), -0.08));
}

TEST_F(NearBendTest, AStraightPipeHasNone)
{
    for (const double last : {0.0, -0.2})
        for (const int count : {100, 1000, 6000}) {
            const std::vector<Vec3d> seen = points(count, last);
            for (const double way : {-0.02, -0.2, -0.4})
                EXPECT_FALSE(bend_at(seen, way)) << way << " " << last << " " << count;
        }
}

// A cylinder that is askew, and off by a little: what a bend's points do to the fit of its pipe.
TEST_F(NearBendTest, AnAxisThatIsOffIsNoBend)
{
    const std::vector<Vec3d> seen = points(3000, 0);
    const auto [u, v] = across(pipe_.cylinder.axis);
    pipe_.cylinder.axis = normalised(pipe_.cylinder.axis + 0.01 * u);
    pipe_.cylinder.radius += 0.0006;
    pipe_.cylinder.point = pipe_.cylinder.point + 0.001 * v;
    EXPECT_FALSE(bend_at(seen, -0.2));
}

// Points of something else near the pipe, all to one side of a wall that crosses it.
TEST_F(NearBendTest, OtherPointsNextToItAreNoBend)
{
    std::vector<Vec3d> seen = points(2000, 0);
    Dice dice(5);
    const auto [u, v] = across(pipe_.cylinder.axis);
    for (int i = 0; i < 300; ++i) {
        const double turn = dice.between(0, pi);
        seen.push_back(map - dice.between(0.1, 0.11) * pipe_.cylinder.axis +
                       (narrow + dice.between(0, 0.02)) * (std::cos(turn) * u + std::sin(turn) * v));
    }
    const auto bend = bend_at(seen, -0.1);
    EXPECT_FALSE(bend) << bend->radius << " " << bend->evidence;
}

// A mitre bends at once: its radius is below that of the pipe.
TEST_F(NearBendTest, ItsRadiusIsAboveThatOfThePipe)
{
    std::vector<Vec3d> seen = points(2000, 0);
    const auto [u, v] = across(pipe_.cylinder.axis);
    Dice dice(6);
    const Vec3d askew = normalised(pipe_.cylinder.axis + u), side = normalised(u - pipe_.cylinder.axis);
    while (seen.size() < 2600) {
        const double turn = dice.between(0, pi);
        const Vec3d p = dice.between(0, 0.2) * askew + narrow * (std::cos(turn) * side + std::sin(turn) * v);
        if (dot(p, pipe_.cylinder.axis + askew) > 0) seen.push_back(map + p);
    }
    const auto bend = bend_at(seen, -0.05);
    EXPECT_TRUE(!bend || bend->radius > narrow);
}

}  // namespace
