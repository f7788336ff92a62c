// Polygons against the rule of their header without bands, and regions made of them against their formulas.

#include "pcm/cloud/polygon.h"

#include "pcm/cloud/matrix.h"
#include "pcm/cloud/region.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <random>

namespace {

using namespace pcm;
using Corners = std::vector<Vec2d>;

double between(std::mt19937_64& random, double low, double high)
{
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

// The rule as the header states it. Corners and points of small integers: nothing is rounded.
bool by_the_rule(const Corners& corners, const Vec2d& p)
{
    bool inside = false;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        Vec2d low = corners[i], high = corners[(i + 1) % corners.size()];
        if (low[1] > high[1]) std::swap(low, high);
        if (!(low[1] <= p[1] && p[1] < high[1])) continue;
        const long double x =
            low[0] + (static_cast<long double>(high[0]) - low[0]) * (p[1] - low[1]) / (high[1] - low[1]);
        if (p[0] < x) inside = !inside;
    }
    return inside;
}

TEST(Polygon, ContainsWhatTheEvenOddRuleGives)
{
    std::mt19937_64 random(1);
    std::size_t inside = 0;
    for (int round = 0; round < 3000; ++round) {
        Corners corners;
        for (std::size_t n = 3 + random() % (round % 10 == 0 ? 500 : 12); n > 0; --n)
            corners.push_back({static_cast<double>(random() % 64), static_cast<double>(random() % 64)});
        const Polygon polygon(corners);
        for (int k = 0; k < 200; ++k) {
            // Many of them on corners and edges.
            const Vec2d p{static_cast<double>(random() % 68) - 2, static_cast<double>(random() % 68) - 2};
            ASSERT_EQ(polygon.contains(p[0], p[1]), by_the_rule(corners, p));
            inside += polygon.contains(p[0], p[1]);
        }
    }
    EXPECT_GT(inside, 100000u);
}

// Each point is in one polygon of a tiling, on borders and corners too.
TEST(Polygon, PolygonsWithACommonEdgeShareNoPointAndLoseNone)
{
    std::mt19937_64 random(2);
    for (int round = 0; round < 500; ++round) {
        const Vec2d middle{between(random, 4e5, 4e5 + 8), between(random, 5e6, 5e6 + 8)};
        const Corners square{{4e5, 5e6}, {4e5 + 8, 5e6}, {4e5 + 8, 5e6 + 8}, {4e5, 5e6 + 8}};
        std::vector<Polygon> parts;
        for (std::size_t k = 0; k < 4; ++k) parts.emplace_back(Corners{square[k], square[(k + 1) % 4], middle});
        for (int k = 0; k < 100; ++k) {
            Vec2d p{between(random, 4e5, 4e5 + 8), between(random, 5e6, 5e6 + 8)};
            if (k % 2) {  // about on an inner edge
                const double t = between(random, 0, 1);
                const std::size_t c = random() % 4;
                for (std::size_t a = 0; a < 2; ++a) p[a] = middle[a] + t * (square[c][a] - middle[a]);
            }
            if (k == 0) p = middle;
            int in = 0;
            for (const Polygon& part : parts) in += part.contains(p[0], p[1]);
            ASSERT_EQ(in, Polygon(square).contains(p[0], p[1]) ? 1 : 0);
        }
    }
}

TEST(Polygon, LeftAndLowerBordersAreInsideAndACrossedPartIsOutside)
{
    const Polygon square({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
    EXPECT_TRUE(square.contains(0, 0));
    EXPECT_TRUE(square.contains(0, 1));
    EXPECT_TRUE(square.contains(1, 0));
    EXPECT_FALSE(square.contains(2, 1));
    EXPECT_FALSE(square.contains(1, 2));
    EXPECT_FALSE(square.contains(NAN, 1));
    EXPECT_FALSE(square.contains(1, NAN));
    // A star of five strokes: its middle is gone around twice.
    Corners star;
    for (int k = 0; k < 5; ++k) star.push_back({std::sin(k * 0.8 * pi), std::cos(k * 0.8 * pi)});
    EXPECT_FALSE(Polygon(star).contains(0, 0));
    EXPECT_TRUE(Polygon(star).contains(0, 0.7));
    // Flat and pointed ones contain nothing.
    EXPECT_FALSE(Polygon({{1, 1}, {1, 1}, {1, 1}}).contains(1, 1));
    EXPECT_FALSE(Polygon({{0, 0}, {1, 1}, {2, 2}}).contains(1, 1));
    EXPECT_FALSE(Polygon({{0, 3}, {5, 3}, {2, 3}}).contains(1, 3));
}

// false: nothing of the border is near. The nearest distance between random points of hulls and of edges.
TEST(Polygon, ABorderThatIsNotNearIsNeverMissed)
{
    std::mt19937_64 random(3);
    std::size_t clear = 0, near = 0;
    for (int round = 0; round < 20000; ++round) {
        Corners corners, points;
        for (std::size_t n = 3 + random() % 10; n > 0; --n)
            corners.push_back({between(random, -1, 1), between(random, -1, 1)});
        const double size = std::pow(10, between(random, -3, 0)), x = between(random, -1, 1),
                     y = between(random, -1, 1);
        for (std::size_t n = 1 + random() % 8; n > 0; --n)
            points.push_back({x + between(random, -size, size), y + between(random, -size, size)});
        const Polygon polygon(corners);
        const double margin = random() % 2 ? 0 : between(random, 0, 0.01);
        if (polygon.border_touches(points, margin)) {
            ++near;
            continue;
        }
        ++clear;
        const bool first = polygon.contains(points[0][0], points[0][1]);
        for (int k = 0; k < 20; ++k) {
            // A point of the hull, moved by no more than the margin.
            Vec2d p = points[random() % points.size()];
            for (int j = 0; j < 3; ++j) {
                const Vec2d& q = points[random() % points.size()];
                const double t = between(random, 0, 1);
                p = {p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])};
            }
            const double angle = between(random, 0, 7);
            ASSERT_EQ(polygon.contains(p[0] + margin * std::cos(angle), p[1] + margin * std::sin(angle)), first);
        }
    }
    EXPECT_GT(clear, 3000u);
    EXPECT_GT(near, 3000u);
}

// Ten thousand corners, a comb with teeth as high as the whole among them: a point costs no walk along all edges.
TEST(Polygon, ThousandsOfCornersTakeLittleTime)
{
    Corners coast;
    std::mt19937_64 random(4);
    for (int k = 0; k < 20000; ++k) {
        const double angle = 2 * pi * k / 20000, r = between(random, 0.95, 1);
        coast.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    Corners ring;
    for (int k = 0; k < 20; ++k) ring.push_back({std::cos(2 * pi * k / 20), std::sin(2 * pi * k / 20)});
    // Processor time of a million points, and the share of these inside.
    const auto cost_of = [&](const Polygon& polygon, double& share) {
        const std::clock_t start = std::clock();
        std::size_t inside = 0;
        for (int k = 0; k < 1000000; ++k) inside += polygon.contains(between(random, -1, 1), between(random, -1, 1));
        share = static_cast<double>(inside) / 1e6;
        return static_cast<double>(std::clock() - start);
    };
    double share = 0, share_of_ring = 0;
    const double many = cost_of(Polygon(coast), share), few = cost_of(Polygon(ring), share_of_ring);
    EXPECT_NEAR(share, pi * 0.975 * 0.975 / 4, 0.01);
    EXPECT_NEAR(share_of_ring, 2.5 * std::sin(pi / 10), 0.01);
    EXPECT_LT(many, 20 * few);  // 1.5; without bands 200
    Corners comb;
    for (int k = 0; k < 10000; ++k) comb.push_back({k + 0.5, k % 2 ? 1.0 : 0.0});
    comb.push_back({10000, -1});
    comb.push_back({0, -1});
    EXPECT_TRUE(Polygon(comb).contains(5000.5, -0.5));
    EXPECT_TRUE(Polygon(comb).contains(5001.5, 0.99));
    EXPECT_FALSE(Polygon(comb).contains(5000.5, 0.99));
}

TEST(RegionPolygon, InPlanSourceCoordinatesAreComparedAsTheyAre)
{
    const Region region = parse_region(
        "polygon 400000.001 5000000.001, 400000.002 5000000.001, 400000.002 5000000.002, "
        "400000.001 5000000.002");
    EXPECT_TRUE(region.contains({400000.001, 5000000.001, -1e9}));
    EXPECT_FALSE(region.contains({std::nextafter(400000.001, 0), 5000000.001, 0}));
    EXPECT_FALSE(region.contains({400000.002, 5000000.001, 0}));
    EXPECT_TRUE(region.contains({std::nextafter(400000.002, 0), 5000000.001, 1e9}));
    EXPECT_TRUE(std::isinf(region.bounds().max[2]));
    EXPECT_NEAR(region.bounds().max[0], 400000.002, 1e-6);
    EXPECT_EQ(region.relation({{400000.0012, 5000000.0012, -5}, {400000.0018, 5000000.0018, 5}}), BoxRelation::inside);
    EXPECT_EQ(region.relation({{400000, 5000000, -5}, {400001, 5000001, 5}}), BoxRelation::crosses);
    EXPECT_EQ(region.relation({{400000.1, 5000000, -5}, {400001, 5000001, 5}}), BoxRelation::outside);
    EXPECT_EQ(region.text().substr(0, 8), "polygon ");
    // A notch: the bounding box of the polygon is met, the polygon is not.
    const Region notched = parse_region("polygon 0 0 10 0 10 10 5 1 0 10");
    EXPECT_EQ(notched.relation({{4.5, 5, 0}, {5.5, 6, 0}}), BoxRelation::outside);
    EXPECT_FALSE(notched.contains({5, 5, 0}));
}

TEST(RegionPolygon, APrismIsThePolygonAlongItsAxes)
{
    std::mt19937_64 random(5);
    std::size_t inside = 0, bounded = 0;
    for (int round = 0; round < 5000; ++round) {
        const double turn = between(random, 0, 7), tilt = round % 2 ? between(random, 0, 7) : 0;
        const Vec3d u{std::cos(turn), std::sin(turn), 0},
            v{-std::sin(turn) * std::cos(tilt), std::cos(turn) * std::cos(tilt), std::sin(tilt)};
        const Vec3d centre{between(random, -1e7, 1e7), between(random, -1e7, 1e7), between(random, -1e3, 1e3)};
        Corners corners;
        for (std::size_t n = 3 + random() % 6; n > 0; --n)
            corners.push_back({between(random, -9, 9), between(random, -9, 9)});
        const Region region = Region::prism(centre, u, 5.0 * v, corners);
        bounded += std::isfinite(region.bounds().max[0]);
        for (int k = 0; k < 20; ++k) {
            const double a = between(random, -9, 9), b = between(random, -9, 9), c = between(random, -50, 50);
            const Vec3d p = centre + a * u + b * v + c * cross(u, v);
            Corners around;
            for (const Vec2d& d : {Vec2d{1e-7, 0}, Vec2d{-1e-7, 0}, Vec2d{0, 1e-7}, Vec2d{0, -1e-7}})
                around.push_back({a + d[0], b + d[1]});
            if (Polygon(corners).border_touches(around, 0)) continue;
            ASSERT_EQ(region.contains(p), by_the_rule(corners, {a, b}));
            inside += region.contains(p);
            if (region.contains(p)) ASSERT_TRUE(region.bounds().contains(p));
        }
    }
    EXPECT_GT(inside, 10000u);
    EXPECT_EQ(bounded, 2500u);  // those in plan
}

struct View {
    Matrix4d modelview{}, projection{};
    double near = 0.5, far = 200;
};

View view_from(const Vec3d& eye, const Vec3d& back)
{
    View view;
    const Vec3d right = normalised(cross({0, 0, 1}, back)), up = cross(back, right);
    const std::array<Vec3d, 3> rows{right, up, back};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t a = 0; a < 3; ++a) view.modelview[a * 4 + r] = rows[r][a];
        view.modelview[12 + r] = -dot(rows[r], eye);
    }
    view.modelview[15] = 1;
    view.projection[0] = 1.3, view.projection[5] = 1.9, view.projection[11] = -1;
    view.projection[10] = (view.far + view.near) / (view.near - view.far);
    view.projection[14] = 2 * view.far * view.near / (view.near - view.far);
    return view;
}

// At map coordinates, against the matrices in extended precision.
TEST(RegionPolygon, ALassoHoldsWhatIsDrawnInIt)
{
    std::mt19937_64 random(6);
    std::size_t inside = 0, decided = 0;
    for (int round = 0; round < 3000; ++round) {
        const Vec3d origin{between(random, -1e7, 1e7), between(random, -1e7, 1e7), between(random, -1e3, 1e3)};
        const Vec3d eye{between(random, -50, 50), between(random, -50, 50), between(random, -50, 50)};
        const View view = view_from(eye, normalised({between(random, -1, 1), between(random, -1, 1), 0.3}));
        Corners corners;
        for (std::size_t n = 3 + random() % 9; n > 0; --n)
            corners.push_back({between(random, -1, 1), between(random, -1, 1)});
        const Region region = Region::lasso(view.modelview, view.projection, origin, corners);
        for (int k = 0; k < 30; ++k) {
            const Vec3d p =
                origin + eye + Vec3d{between(random, -99, 99), between(random, -99, 99), between(random, -99, 99)};
            long double clip[4] = {0, 0, 0, 0}, seen[4] = {0, 0, 0, 1};
            for (std::size_t r = 0; r < 3; ++r) {
                seen[r] = view.modelview[12 + r];
                for (std::size_t a = 0; a < 3; ++a)
                    seen[r] += static_cast<long double>(view.modelview[a * 4 + r]) *
                               (static_cast<long double>(p[a]) - origin[a]);
            }
            for (std::size_t r = 0; r < 4; ++r)
                for (std::size_t c = 0; c < 4; ++c) clip[r] += view.projection[c * 4 + r] * seen[c];
            const double x = static_cast<double>(clip[0] / clip[3]), y = static_cast<double>(clip[1] / clip[3]);
            if (std::fabs(clip[3] - view.near) < 1e-6 || std::fabs(clip[3] - view.far) < 1e-6 ||
                Polygon(corners).border_touches({{x, y}}, 1e-7))
                continue;
            const bool drawn = clip[3] > view.near && clip[3] < view.far && by_the_rule(corners, {x, y});
            ASSERT_EQ(region.contains(p), drawn) << region.text();
            ++decided;
            inside += drawn;
            if (drawn) ASSERT_TRUE(region.bounds().contains(p));
        }
    }
    EXPECT_GT(decided, 80000u);
    EXPECT_GT(inside, 1000u);
}

TEST(RegionPolygon, ABoxAroundTheEyeIsNeverClassifiedFalsely)
{
    const View view = view_from({0, 0, 0}, {0, -1, 0});
    const Vec3d origin{5e5, 5e6, 100};
    const Region region = Region::lasso(view.modelview, view.projection, origin, {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
    const auto box = [&](const Vec3d& low, const Vec3d& high) { return Box3d{origin + low, origin + high}; };
    EXPECT_EQ(region.relation(box({-300, -300, -300}, {300, 300, 300})), BoxRelation::crosses);
    EXPECT_EQ(region.relation(box({-1, -1, -1}, {1, 1, 1})), BoxRelation::crosses);
    EXPECT_EQ(region.relation(box({-1, -9, -1}, {1, -1, 1})), BoxRelation::outside);  // behind
    EXPECT_EQ(region.relation(box({-1, 10, -1}, {1, 20, 1})), BoxRelation::inside);
    EXPECT_EQ(region.relation(box({-1, 190, -1}, {1, 210, 1})), BoxRelation::crosses);  // the far plane
    EXPECT_EQ(region.relation(box({-1, 201, -1}, {1, 210, 1})), BoxRelation::outside);
    EXPECT_EQ(region.relation(box({30, 10, -1}, {40, 20, 1})), BoxRelation::outside);  // next to it
    EXPECT_TRUE(std::isfinite(region.bounds().max[0]) && std::isfinite(region.bounds().max[1]));
}

}  // namespace
