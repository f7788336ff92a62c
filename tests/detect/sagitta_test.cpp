// How much of a curved shape points show.

#include "pcm/detect/sagitta.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

std::vector<Vec3d> arc_of(double radius, double from, double to)
{
    std::vector<Vec3d> points;
    for (int i = 0; i <= 40; ++i)
        for (const double z : {0.0, 0.3, 1.0}) {
            const double angle = from + (to - from) * i / 40;
            points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
        }
    return points;
}

TEST(Sagitta, IsTheRiseOfAnArcOverItsChord)
{
    const pcm::Shape pipe = parse_shape("cylinder 0 0 0 0 0 1 0.2");
    for (const double turn : {0.2, 1.0, 2.0, 3.1}) {
        EXPECT_NEAR(turn_of(pipe, arc_of(0.2, 0.7, 0.7 + turn)), turn, 1e-9) << turn;
        // The chord between the arc's ends is r cos(turn / 2) from the axis.
        EXPECT_NEAR(sagitta_of(pipe, turn), 0.2 - 0.2 * std::cos(turn / 2), 1e-12);
    }
    EXPECT_NEAR(turn_of(pipe, arc_of(0.2, 0, 2 * pi)), pi, 1e-9);
    EXPECT_NEAR(sagitta_of(pipe, pi), 0.2, 1e-12);
    // The first point's normal is in the middle of the others.
    std::vector<Vec3d> points = arc_of(0.2, 0, 1.2);
    std::swap(points.front(), points[points.size() / 2]);
    EXPECT_NEAR(turn_of(pipe, points), 1.2, 1e-9);
}

TEST(Sagitta, PlanesAndNoPointsHaveNone)
{
    EXPECT_EQ(turn_of(parse_shape("sphere 0 0 0 1"), {}), 0);
    EXPECT_EQ(turn_of(parse_shape("plane 0 0 0 0 0 1"), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 0);
    EXPECT_EQ(sagitta_of(parse_shape("plane 0 0 0 0 0 1"), 2), 0);
}

}  // namespace
