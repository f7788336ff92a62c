// A bend with straight tubes at its ends, whose numbers are known.
#include "pcm/place/bent_tube.h"

#include "tests/place/shape_cloud.h"

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double tube_noise = 0.0015;
constexpr Vec3d tube_middle{456780, 5432100, 120};

// A bend of this angle with straight tubes of this length at its beginning and its end, seen from all sides.
struct Bend {
    pcm::Shape torus;
    Vec3d u{}, v{}, start{};
    std::vector<Vec3d> points;

    Bend(double angle, double first, double last, std::uint64_t seed, double radius = 0.229)
    {
        torus.kind = ShapeKind::torus;
        torus.point = tube_middle;
        torus.axis = normalised({0.3, -0.4, 1});
        torus.radius = radius;
        torus.second = 0.084;
        const auto axes = across(torus.axis);
        u = axes[0];
        v = axes[1];
        start = std::cos(angle / 2 + pi) * u + std::sin(angle / 2 + pi) * v;
        Dice dice(seed);
        for (int i = 0; i < 3000; ++i) {
            const double way = dice.between(-first, torus.radius * angle + last);
            const double at = std::min(std::max(way / torus.radius, 0.0), angle);
            const Vec3d out = std::cos(at) * u + std::sin(at) * v, on = std::cos(at) * v - std::sin(at) * u;
            const double b = dice.between(0, 2 * pi);
            const Vec3d n = std::cos(b) * out + std::sin(b) * torus.axis;
            points.push_back(tube_middle + torus.radius * out + (way - torus.radius * at) * on +
                             (torus.second + tube_noise * dice.normal()) * n);
        }
    }
    double angle_of(double angle) const
    {
        return angle_about(torus, start, tube_middle + std::cos(angle) * u + std::sin(angle) * v);
    }
};

TEST(BentTube, AnglesAreCountedFromTheDirectionThatIsGiven)
{
    const Bend bend(1, 0, 0, 1);
    EXPECT_NEAR(angle_about(bend.torus, bend.u, tube_middle + 5 * bend.u + 0.001 * bend.v), 0.0002, 1e-6);
    EXPECT_NEAR(angle_about(bend.torus, bend.u, tube_middle + bend.v + 7 * bend.torus.axis), pi / 2, 1e-6);
    EXPECT_NEAR(angle_about(bend.torus, bend.u + 3 * bend.torus.axis, tube_middle - bend.v), 1.5 * pi, 1e-6);
}

// From a torus as all of the points together give it: far too wide.
TEST(BentTube, EndsAndRadiiAreThoseOfTheBend)
{
    for (const double angle : {pi / 4, pi / 2, 2.2}) {
        const Bend bend(angle, 0.1, 0.15, 2);
        pcm::Shape wide = bend.torus;
        wide.radius = 0.3;
        wide.point = tube_middle - 0.07 * (std::cos(angle / 2) * bend.u + std::sin(angle / 2) * bend.v);
        const auto tube =
            fit_bent_tube(wide, bend.start, ends_between(bend.angle_of(-0.3), bend.angle_of(angle + 0.4)), bend.points);
        ASSERT_TRUE(tube) << angle;
        EXPECT_NEAR(tube->torus.radius, 0.229, 0.003) << angle;
        EXPECT_NEAR(tube->torus.second, 0.084, 0.0002);
        EXPECT_LT(length(tube->torus.point - tube_middle), 0.003);
        EXPECT_LT(std::fabs(tube->from - bend.angle_of(0)), 4 * tube->from_error);
        EXPECT_LT(std::fabs(tube->to - bend.angle_of(angle)), 4 * tube->to_error);
        EXPECT_LT(tube->to_error, 0.03);
        EXPECT_GT(tube->to_error, 0.0005);
        EXPECT_NEAR(std::sqrt(tube->squares / 3000), tube_noise, 0.05 * tube_noise);
    }
}

TEST(BentTube, WhereNoTubeLeavesTheBendThereIsNoEnd)
{
    const Bend bend(pi / 2, 0.15, 0, 3);
    const auto tube =
        fit_bent_tube(bend.torus, bend.start, ends_between(bend.angle_of(-0.4), bend.angle_of(pi / 2)), bend.points);
    ASSERT_TRUE(tube);
    EXPECT_LT(std::fabs(tube->from - bend.angle_of(0)), 4 * tube->from_error);
    EXPECT_TRUE(tube->to_error > 0.02 || tube->to > bend.angle_of(pi / 2) - 0.05) << tube->to << " " << tube->to_error;
}

// Pipes that are cut at an angle and joined: the closer the bend, the better it fits, but a torus has a hole.
TEST(BentTube, AMitreIsNoBend)
{
    const Bend mitre(pi / 2, 0.3, 0.3, 4, 0.04);
    pcm::Shape wide = mitre.torus;
    wide.radius = 0.12;
    wide.point = tube_middle - 0.08 * (std::cos(pi / 4) * mitre.u + std::sin(pi / 4) * mitre.v);
    const auto tube = fit_bent_tube(wide, mitre.start, ends_between(mitre.angle_of(-0.8), mitre.angle_of(pi / 2 + 0.8)),
                                    mitre.points);
    if (tube) EXPECT_LT(tube->torus.second, tube->torus.radius);
}

// Points farther than that from the tube are of something else: they do not move it.
TEST(BentTube, IsFittedToPointsWithinADistance)
{
    Bend bend(pi / 2, 0.15, 0.15, 5);
    const std::size_t own = bend.points.size();
    for (std::size_t i = 0; i < own; i += 4) bend.points.push_back(bend.points[i] + 0.03 * bend.torus.axis);
    const auto fit = [&](double farthest) {
        return fit_bent_tube(bend.torus, bend.start, ends_between(bend.angle_of(-0.4), bend.angle_of(pi / 2 + 0.4)),
                             bend.points, farthest);
    };
    const auto with = fit(infinity), without = fit(4 * tube_noise);
    ASSERT_TRUE(with && without);
    EXPECT_GT(length(with->torus.point - tube_middle), 0.003);
    EXPECT_LT(length(without->torus.point - tube_middle), 0.002);
    EXPECT_GT(without->on_tube, own - own / 100);
    EXPECT_LT(without->on_tube, own + own / 8);
    EXPECT_NEAR(std::sqrt(without->variance), tube_noise, 0.1 * tube_noise);
    EXPECT_GT(without->squares, 2 * without->variance * static_cast<double>(without->on_tube));
}

}  // namespace
