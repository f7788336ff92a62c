// The corner at a place: which of two or three faces a place next to an edge belongs to.
#include "pcm/place/corner_at_place.h"

#include "tests/place/shape_cloud.h"

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double corner_noise = 0.0013, corner_reach = 0.07;
constexpr Vec3d corner_place{456780, 5432100, 120};

// A plate along z whose edge has the normal x: its edge lies at x = 0, its faces at y = +-thickness / 2, and reach to
// x = -0.1. Points lie at random where a scanner that sees all of it would have them, 5 mm apart on average.
std::vector<Vec3d> plate(double thickness, bool has_back, Dice& dice)
{
    constexpr double deep = 0.1, tall = 0.4, density = 1 / (0.005 * 0.005);
    std::vector<Vec3d> points;
    const auto add = [&](double area, const auto& at) {
        for (int i = 0; i < static_cast<int>(area * density); ++i) points.push_back(corner_place + at());
    };
    const auto away = [&] { return corner_noise * dice.normal(); };
    const auto z = [&] { return dice.between(-tall / 2, tall / 2); };
    add(deep * tall, [&] { return Vec3d{dice.between(-deep, 0), thickness / 2 + away(), z()}; });
    if (has_back) add(deep * tall, [&] { return Vec3d{dice.between(-deep, 0), -thickness / 2 + away(), z()}; });
    add(thickness * tall, [&] { return Vec3d{away(), dice.between(-thickness / 2, thickness / 2), z()}; });
    return points;
}

NearPoints nearest(const std::vector<Vec3d>& points, const Vec3d& place)
{
    std::vector<Vec3d> sorted = points;
    const auto is_nearer = [&](const Vec3d& a, const Vec3d& b) { return length(a - place) < length(b - place); };
    std::sort(sorted.begin(), sorted.end(), is_nearer);
    sorted.resize(std::min<std::size_t>(sorted.size(), 500));
    NearPoints near;
    near.points = FitPoints::of(sorted);
    near.ids.resize(sorted.size());
    near.found = sorted.size();
    return near;
}

std::optional<Corner> corner_of(const std::vector<Vec3d>& points, const Vec3d& offset)
{
    const Vec3d place = corner_place + offset;
    return corner_near(place, nearest(points, place), {});
}

// Number of the faces, of four seeds, that are clear and of this normal.
int right_of(double thickness, bool has_back, const Vec3d& offset, const Vec3d& normal)
{
    int right = 0;
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        Dice dice(seed);
        const auto corner = corner_of(plate(thickness, has_back, dice), offset);
        right += corner && corner->margin >= 2 && std::fabs(dot(corner->plane_at_place().axis, normal)) > 0.97;
    }
    return right;
}

TEST(CornerAtPlace, NarrowEdgesOfPlatesAreFaces)
{
    for (const double thickness : {0.01, 0.012, 0.02})
        for (const bool has_back : {true, false})
            EXPECT_GE(right_of(thickness, has_back, {}, {1, 0, 0}), 3) << thickness << has_back;
}

TEST(CornerAtPlace, WideFacesNextToAnEdgeAreFaces)
{
    EXPECT_EQ(right_of(0.1, true, {-0.0035, 0.05, 0}, {0, 1, 0}), 4);
    EXPECT_EQ(right_of(0.1, true, {0, 0.045, 0}, {1, 0, 0}), 4);
}

TEST(CornerAtPlace, ThePlateHasABackWhereItIsSeen)
{
    Dice dice(5);
    const auto both = corner_of(plate(0.014, true, dice), {});
    ASSERT_TRUE(both && both->back);
    EXPECT_NEAR(std::fabs(dot(both->back->axis, both->widest.axis)), 1, 1e-3);
    EXPECT_NEAR(std::fabs(dot(both->widest.axis, both->back->point - both->widest.point)), 0.014, 0.001);
    const auto one = corner_of(plate(0.014, false, dice), {});
    ASSERT_TRUE(one);
    EXPECT_FALSE(one->back);
    std::vector<Vec3d> points = plate(0.014, false, dice);
    for (int i = 0; i < 4000; ++i)
        points.push_back(corner_place +
                         Vec3d{dice.between(-0.1, -0.01), dice.between(-0.06, 0), dice.between(-0.2, 0.2)});
    const auto filled = corner_of(points, {});
    EXPECT_FALSE(filled && filled->back) << "points anywhere behind it";
}

// Half a standard deviation from the edge, a place may be of either face.
TEST(CornerAtPlace, TheEdgeItselfIsUnclear)
{
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        Dice dice(seed);
        const auto corner = corner_of(plate(0.1, true, dice), {-0.0007, 0.0499, 0});
        ASSERT_TRUE(corner);
        EXPECT_LT(corner->margin, 2);
    }
}

// An I-beam along x, 240 mm high, seen from above: its points are 15 mm apart on average.
std::vector<Vec3d> beam(Dice& dice)
{
    constexpr double length = 3, density = 1 / (0.015 * 0.015);
    std::vector<Vec3d> points;
    const auto add = [&](double width, const auto& at) {
        for (int i = 0; i < static_cast<int>(length * width * density); ++i)
            points.push_back(corner_place + Vec3d{dice.between(-length / 2, length / 2), 0, 0} + at());
    };
    const auto away = [&] { return corner_noise * dice.normal(); };
    for (const double flange : {0.12, -0.108}) {
        add(0.15, [&] { return Vec3d{0, dice.between(-0.075, 0.075), flange + away()}; });
        for (const double side : {-0.075, 0.075})
            add(0.012, [&] { return Vec3d{0, side + away(), dice.between(flange - 0.012, flange)}; });
    }
    for (const double side : {-0.004, 0.004})
        add(0.216, [&] { return Vec3d{0, side + away(), dice.between(-0.108, 0.108)}; });
    return points;
}

// Other surfaces around: fewer points on the faces show that a place may be of either than which one it is of.
TEST(CornerAtPlace, AmongOtherFacesOfABeamTheEdgeIsUnclearToo)
{
    int unclear = 0, clear = 0;
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        Dice dice(seed);
        const std::vector<Vec3d> points = beam(dice);
        const auto at_edge = corner_of(points, {0, 0.0745, 0.1195});
        unclear += at_edge && at_edge->edge && at_edge->margin < 2 && at_edge->held < 0.55;
        const auto on_face = corner_of(points, {0, 0.05, 0.12});
        clear += !on_face || !on_face->edge || on_face->margin >= 2;
    }
    EXPECT_GE(unclear, 4);
    EXPECT_EQ(clear, 6);
}

// Where a plane ends and nothing begins, the margin is the way to its border.
TEST(CornerAtPlace, ABorderHasNoOtherFace)
{
    Dice dice(6);
    std::vector<Vec3d> points;
    for (int i = 0; i < 4000; ++i)
        points.push_back(corner_place +
                         Vec3d{dice.between(-0.2, 0), corner_noise * dice.normal(), dice.between(-0.2, 0.2)});
    const auto at_border = corner_of(points, {-0.001, 0, 0});
    ASSERT_TRUE(at_border);
    EXPECT_FALSE(at_border->edge);
    EXPECT_LT(at_border->margin, 2);
    const auto within = corner_of(points, {-0.0033, 0, 0});
    ASSERT_TRUE(within);
    EXPECT_GT(within->margin, at_border->margin);
    const auto far = corner_of(points, {-0.02, 0, 0});
    ASSERT_TRUE(far);
    EXPECT_FALSE(far->edge);
    EXPECT_GT(far->margin, 10);
    EXPECT_FALSE(far->side(corner_place));
    EXPECT_FALSE(corner_of(points, {-0.02, 0.006, 0})) << "the place is not on the plane";
}

// The side of a face holds its points and not those of the other faces.
TEST(CornerAtPlace, SidesPartTheFaces)
{
    Dice dice(8);
    const std::vector<Vec3d> points = plate(0.014, true, dice);
    const auto corner = corner_of(points, {});
    ASSERT_TRUE(corner && corner->edge && corner->margin >= 2);
    const std::optional<Region> side = corner->side(corner_place);
    ASSERT_TRUE(side);
    int of_edge = 0, held = 0, strange = 0;
    for (const Vec3d& p : points) {
        const Vec3d d = p - corner_place;
        if (std::fabs(d[1]) < 0.004 && d[0] > -0.004) ++of_edge, held += side->contains(p);
        if (d[0] < -0.008) strange += side->contains(p) && std::fabs(d[1]) > 0.004;
    }
    EXPECT_GT(of_edge, 100);
    EXPECT_GE(held, of_edge * 98 / 100);
    EXPECT_LE(strange, 5);
}

// The thin leg of an angle: its points are those of the face next to the widest one, and end at the place, too.
TEST(CornerAtPlace, TheEndOfAThinLegIsNotItsSide)
{
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        Dice dice(seed);
        std::vector<Vec3d> points;
        const auto away = [&] { return corner_noise * dice.normal(); };
        const auto along = [&] { return dice.between(-0.2, 0.2); };
        for (int i = 0; i < 3000; ++i)
            points.push_back(corner_place + Vec3d{dice.between(-0.1, 0), away() - 0.02, along()});
        for (int i = 0; i < 300; ++i) {
            points.push_back(corner_place + Vec3d{away() + 0.003, dice.between(-0.02, 0), along()});
            points.push_back(corner_place + Vec3d{away() - 0.003, dice.between(-0.02, 0), along()});
        }
        for (int i = 0; i < 100; ++i)
            points.push_back(corner_place + Vec3d{dice.between(-0.003, 0.003), away(), along()});
        const auto corner = corner_of(points, {});
        EXPECT_FALSE(corner && corner->margin >= 2 && std::fabs(corner->plane_at_place().axis[0]) > 0.9) << seed;
    }
}

TEST(CornerAtPlace, ThinPipesAreNone)
{
    Dice dice(7);
    std::vector<Vec3d> points;
    for (int i = 0; i < 6000; ++i) {
        const double a = dice.between(0, pi), r = 0.05 + 0.5 * corner_noise * dice.normal();
        points.push_back(corner_place + Vec3d{r * std::cos(a), r * std::sin(a), dice.between(-0.5, 0.5)});
    }
    for (const double a : {0.1, 0.8, 1.57}) {
        const auto corner = corner_of(points, {0.05 * std::cos(a), 0.05 * std::sin(a), 0});
        EXPECT_FALSE(corner && corner->edge && !(corner->held >= 0.55 && corner->away <= 3.3)) << a;
    }
}

// Noise of the points is learned, and is at least half of the given one.
TEST(CornerAtPlace, ItsNoiseIsLearned)
{
    Dice dice(9);
    const std::vector<Vec3d> points = plate(0.1, true, dice);
    const Vec3d place = corner_place + Vec3d{0, 0.048, 0};
    const NearPoints near = nearest(points, place);
    const auto of_more = corner_at(place, near.points, 2 * corner_noise, {}),
               of_most = corner_at(place, near.points, 4 * corner_noise, {});
    ASSERT_TRUE(of_more && of_most);
    EXPECT_NEAR(of_more->noise, corner_noise, 0.2 * corner_noise);
    EXPECT_DOUBLE_EQ(of_most->noise, 2 * corner_noise);
}

}  // namespace
