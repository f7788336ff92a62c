// The perspective mode, fragment by fragment, against rays that are cast on the CPU in double.
#include "tests/gl/splat_scene.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>
#include "pcm/cloud/vector.h"

#include <cmath>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

Vec3d random_direction(std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    return {normal(random), normal(random), normal(random)};
}

// Discs in front of an eye at the origin that looks down -z, at distances in proportion to `unit`.
std::vector<Disc> random_discs(std::size_t count, double unit, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<Disc> discs;
    for (std::size_t d = 0; d < count; ++d) {
        const double depth = (6 + 4 * even(random)) * unit;
        discs.push_back({{0.8 * depth * even(random), 0.6 * depth * even(random), -depth},
                         random_direction(random),
                         (0.5 + 0.45 * even(random)) * unit});
    }
    return discs;
}

// A disc seen at the angle `graze` to its plane, its centre in the direction of (x, y, -1); `turn` rotates it about the
// ray.
Disc grazing_disc(double x, double y, double depth, double radius, double degrees, double turn)
{
    const Vec3d ray{x, y, -1};
    const Vec3d d = normalised(ray);
    const Vec3d side = normalised(cross(d, {0.1, 0.9, 0.3}));
    const Vec3d up = cross(d, side);
    Disc disc;
    const double angle = degrees * pi / 180;
    for (std::size_t a = 0; a < 3; ++a) {
        disc.centre[a] = depth * ray[a];
        disc.normal[a] = std::cos(angle) * (std::cos(turn) * side[a] + std::sin(turn) * up[a]) - std::sin(angle) * d[a];
    }
    disc.radius = radius;
    return disc;
}

void expect_exact(const Agreement& a, std::size_t least_covered, bool doubles, double tolerance = 1e-4)
{
    if (!doubles) tolerance = std::max(tolerance, 3e-4);

    EXPECT_GE(a.covered, least_covered);
    EXPECT_GE(a.certain, std::size_t(width * height) * 8 / 10);
    EXPECT_EQ(a.wrong_coverage, 0u);
    EXPECT_EQ(a.wrong_disc, 0u);
    EXPECT_EQ(a.not_numbers, 0u);
    EXPECT_LE(a.worst_depth, tolerance);
    if (std::getenv("PCM_TEST_FIGURES"))
        std::printf("    covered %zu, worst depth %.2e radii\n", a.covered, a.worst_depth);
}

Grid fine_grid(double step, const Vec3d& offset = {0, 0, 0}) { return {{step, step, step}, offset}; }

}  // namespace

class SplatDisc : public testing::TestWithParam<bool> {};  // with doubles or without
INSTANTIATE_TEST_SUITE_P(Precision, SplatDisc, testing::Bool(),
                         [](const auto& p) { return p.param ? "doubles" : "floats"; });

TEST_P(SplatDisc, AFieldOfDiscs)
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        const SplatScene scene(fine_grid(1e-6), random_discs(60, 1, 1));
        const Camera view = view_of(identity(), perspective(1, aspect, 0.1, 100), width, height);
        expect_exact(compare(scene, view, true, GetParam()), 5000, GetParam());
        // The usual convention: near is 0. A float near 1 resolves depths around 10 to 6e-8 * 100 / 0.1.
        expect_exact(compare(scene, view, false, GetParam()), 5000, GetParam(), 1.2e-3);
        const Camera near = view_of(identity(), perspective(1, aspect, 1.5, 20), width, height);
        expect_exact(compare(scene, near, false, GetParam()), 5000, GetParam());
    }
}

TEST_P(SplatDisc, OrthographicViews)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const SplatScene scene(fine_grid(1e-6), random_discs(60, 1, 2));
    for (const bool reversed : {true, false}) {
        expect_exact(compare(scene, view_of(identity(), orthographic(5, 5 / aspect, 0.1, 20), width, height), reversed,
                             GetParam()),
                     3000, GetParam());
        // The near plane cuts some discs, and may lie behind the eye.
        expect_exact(compare(scene, view_of(identity(), orthographic(5, 5 / aspect, 5, 20), width, height), reversed,
                             GetParam()),
                     1000, GetParam());
        expect_exact(compare(scene, view_of(translation(0, 0, 15), orthographic(5, 5 / aspect, -20, 20), width, height),
                             reversed, GetParam()),
                     3000, GetParam());
    }
}

TEST_P(SplatDisc, OffAxisTurnedAndStretched)
{
    PCM_REQUIRE_GL(context, Profile::core);
    Matrix off_axis = perspective(1, aspect, 0.1, 100);
    off_axis[8] = 0.35;
    off_axis[9] = -0.2;
    const SplatScene scene(fine_grid(1e-6), random_discs(60, 1, 3));
    expect_exact(compare(scene, view_of(identity(), off_axis, width, height), true, GetParam()), 4000, GetParam());
    const Matrix turned = product(translation(0, 0, -6), product(rotation_x(0.7), translation(0, 0, 6)));
    expect_exact(compare(scene, view_of(turned, off_axis, width, height), true, GetParam()), 2000, GetParam());
    Matrix scaled = turned;
    for (double& v : scaled) v *= 7;  // all sixteen elements: the same transformation
    expect_exact(compare(scene, view_of(scaled, off_axis, width, height), true, GetParam()), 2000, GetParam());
    // A placement that shrinks the cloud; and one that stretches it, under which discs become ellipses.
    Matrix placement = identity();
    placement[0] = placement[5] = placement[10] = 1e-3;
    expect_exact(compare(scene, view_of(placement, perspective(1, aspect, 1e-4, 0.1), width, height), true, GetParam()),
                 4000, GetParam());
    placement[0] = 1.5e-3;
    expect_exact(compare(scene, view_of(placement, perspective(1, aspect, 1e-4, 0.1), width, height), true, GetParam()),
                 3000, GetParam());
}

// Not under the address sanitizer: much drawing in software.
TEST_P(SplatDisc, PCM_NOT_UNDER_ADDRESS(GrazesDownToATenthOfADegree))
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Little of such a disc is visible, so it must be large: from half the picture's width to several times that.
    const Camera view = view_of(identity(), perspective(0.6, aspect, 0.01, 100), width, height);
    std::size_t covered = 0;
    for (const double degrees : {0.1, 0.3, 1.0, 5.0})
        for (const auto& [x, y] :
             {std::pair{0.0, 0.0}, std::pair{0.2, 0.1}, std::pair{-0.1, 0.22}, std::pair{0.35, 0.0}})
            for (const double radius : {1.0, 4.0, 9.5, 40.0})
                for (const double turn : {0.0, 0.4, 1.3, 2.9}) {
                    SCOPED_TRACE(testing::Message() << degrees << " degrees at " << x << ", " << y << ", radius "
                                                    << radius << ", turned by " << turn);
                    const SplatScene scene(fine_grid(1e-6), {grazing_disc(x, y, 10, radius, degrees, turn)});
                    const Agreement a = compare(scene, view, true, GetParam());
                    expect_exact(a, 0, GetParam());
                    covered += a.covered;
                }
    EXPECT_GT(covered, 150'000u);
}

TEST_P(SplatDisc, CrossingTheNearPlaneAndBehindTheEye)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // The eye is among the discs: many are cut by the near plane, or have their centres behind the eye or next to the
    // view.
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> even(-1, 1);
    for (int round = 0; round < 12; ++round) {
        std::vector<Disc> discs;
        for (int d = 0; d < 12; ++d)
            discs.push_back({{2 * even(random), 2 * even(random), 2 * even(random)},
                             random_direction(random),
                             1 + 0.9 * even(random)});
        const SplatScene scene(fine_grid(1e-7), discs);
        for (const double near : {0.5, 0.01, 1e-5}) {
            SCOPED_TRACE(testing::Message() << "round " << round << ", near " << near);
            expect_exact(compare(scene, view_of(identity(), perspective(1.2, aspect, near, 10), width, height), true,
                                 GetParam()),
                         500, GetParam());
        }
    }
}

TEST_P(SplatDisc, SmallAndLargeInOneView)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Radii from 1e-6 to 1e6, each at the depth where it covers some pixels, and on a floor of radius 1e6; near / far
    // is 1e-12.
    for (int e = -6; e <= 6; ++e) {
        const double unit = std::pow(10.0, e);
        SCOPED_TRACE(testing::Message() << "radii of 1e" << e);
        const SplatScene scene(fine_grid(1e-6 * unit), random_discs(40, unit, 5));
        expect_exact(
            compare(scene, view_of(identity(), perspective(1, aspect, 1e-6, 2e7), width, height), true, GetParam()),
            3000, GetParam());
    }
    // One chunk with both: the small discs are in front of the large.
    std::vector<Disc> both = random_discs(20, 1e-6, 6);
    const double step = 1e-12;
    for (const Disc& disc : random_discs(20, 1, 7)) both.push_back(disc);
    const SplatScene scene(fine_grid(step), both);
    expect_exact(compare(scene, view_of(identity(), perspective(1, aspect, 1e-6, 1), width, height), true, GetParam()),
                 1000, GetParam());
    expect_exact(
        compare(scene, view_of(identity(), perspective(1, aspect, 1e-3, 1e3), width, height), true, GetParam()), 3000,
        GetParam());
    const SplatScene floor(fine_grid(1e-3),
                           {{{3e5, -1.7, -2e5}, {0, 1, 0}, 1e6}, {{-4e5, 900, 3e5}, {0.001, 1, 0.002}, 1e6}});
    expect_exact(
        compare(floor, view_of(identity(), perspective(1, aspect, 1e-3, 1e3), width, height), true, GetParam()), 4000,
        GetParam());
    expect_exact(compare(floor, view_of(identity(), perspective(1, aspect, 1, 1e6), width, height), true, GetParam()),
                 5000, GetParam());
}

TEST_P(SplatDisc, AtMapCoordinates)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Discs of a centimetre, five million metres from the origin, in a chunk of two kilometres, with an eye half a
    // metre away.
    const Vec3d eye{5e6 + 987.6543, 4.8e6 + 1234.5678, 321.0987};
    std::vector<Disc> discs = random_discs(60, 0.02, 8);
    for (Disc& disc : discs)
        for (std::size_t a = 0; a < 3; ++a) disc.centre[a] += eye[a];
    discs.push_back({{5e6, 4.8e6, 0}, {0, 0, 1}, 0.01});
    discs.push_back({{5e6 + 2000, 4.8e6 + 2000, 500}, {0, 0, 1}, 0.01});
    const Grid grid = fine_grid(1e-4, {5e6, 4.8e6, 0});
    const SplatScene scene(grid, discs);
    // The local origin next to the cloud; and at 0, as in a host that does not shift: then the modelview has the size
    // of the coordinates.
    const Vec3d origin{5e6 + 1000, 4.8e6 + 1000, 0};
    const Matrix shifted = translation(origin[0] - eye[0], origin[1] - eye[1], origin[2] - eye[2]);
    const Matrix far = perspective(1, aspect, 1e-3, 1e3);
    expect_exact(compare(scene, view_of(shifted, far, width, height, origin), true, GetParam()), 4000, GetParam());
    // There the resolution of double is 1e-9 m, a ten-millionth of the radius.
    expect_exact(compare(scene, view_of(translation(-eye[0], -eye[1], -eye[2]), far, width, height), true, GetParam()),
                 4000, GetParam());
}

TEST_P(SplatDisc, BeyondTheLargestPointAndWithItsCentreOutside)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Larger than the driver's largest point: the picture is four times as wide.
    float range[2] = {0, 0};
    glGetFloatv(GL_POINT_SIZE_RANGE, range);
    const int wide = std::min(4 * static_cast<int>(range[1]), 1200);
    const Camera view = view_of(identity(), perspective(0.4, wide / 40.0, 0.1, 100), wide, 40);
    std::vector<Disc> discs;
    for (int d = 0; d < 9; ++d)
        discs.push_back({{-8.0 + 2 * d, 0.3 * d - 1, -4 - 0.5 * d}, {0.1 * d - 0.5, 0.4, 1}, 0.4 + 0.4 * d});
    const SplatScene scene(fine_grid(1e-6), discs);
    const Agreement a = compare(scene, view, true, GetParam());
    EXPECT_GT(a.covered, 8000u);
    EXPECT_EQ(a.wrong_coverage + a.wrong_disc + a.not_numbers, 0u);
    EXPECT_LE(a.worst_depth, GetParam() ? 1e-4 : 3e-4);
    // Small discs, drawn as points, with their centres just outside the picture.
    std::vector<Disc> border;
    for (int d = 0; d < 40; ++d) {
        const double along = (d % 10 - 4.5) * 0.2;
        const double edge = std::tan(0.5) * 5 * 1.02;
        const Vec3d centre = d < 10   ? Vec3d{along, edge, -5}
                             : d < 20 ? Vec3d{along, -edge, -5}
                             : d < 30 ? Vec3d{edge * aspect, along, -5}
                                      : Vec3d{-edge * aspect, along, -5};
        border.push_back({centre, {0.1, 0.2, 1}, 0.15});
    }
    const SplatScene around(fine_grid(1e-6), border);
    for (const bool reversed : {true, false}) {
        const Agreement b =
            compare(around, view_of(identity(), perspective(1, aspect, 0.1, 10), width, height), reversed, GetParam());
        EXPECT_GT(b.covered, 100u);
        EXPECT_EQ(b.wrong_coverage + b.wrong_disc, 0u);
        expect_exact(compare(around, view_of(identity(), orthographic(2.7 * aspect, 2.7, 0.1, 10), width, height),
                             reversed, GetParam()),
                     100, GetParam());
    }
}
