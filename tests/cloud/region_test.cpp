// Regions: contains() against the formulas in extended precision, relation() against contains(), refusals, text.

#include "pcm/cloud/region.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace {

using namespace pcm;
using Long = long double;
using Kind = Region::Kind;

class Numbers {
public:
    explicit Numbers(std::uint64_t seed) : random_(seed) {}
    double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    std::size_t below(std::size_t n) { return random_() % n; }
    Vec3d vector(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
    Vec3d direction()
    {
        if (below(3) == 0) {
            Vec3d axis{};
            axis[below(3)] = below(2) ? 1 : -1;
            return axis;
        }
        for (;;) {
            const Vec3d v = vector(1);
            if (length(v) > 0.1) return v;
        }
    }
    // From near to far, and in between.
    double size() { return std::pow(10.0, between(-6, 9)); }

private:
    std::mt19937_64 random_;
};

std::vector<Vec2d> random_polygon(Numbers& numbers, double reach)
{
    std::vector<Vec2d> corners;
    for (std::size_t n = numbers.below(8) ? 3 + numbers.below(9) : 100; n > 0; --n)
        corners.push_back({numbers.between(-reach, reach), numbers.between(-reach, reach)});
    return corners;
}

Region random_prism(Numbers& numbers, const Vec3d& centre, double size)
{
    const Vec3d u = numbers.direction(), v = cross(u, std::fabs(u[2]) < 0.5 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0});
    return Region::prism(centre, u, v, random_polygon(numbers, size));
}

Region random_lasso(Numbers& numbers, const Vec3d& centre, double size)
{
    // Seen from near the centre, in any direction, in perspective or not.
    const Vec3d back = normalised(numbers.direction());
    const Vec3d right = normalised(cross(std::fabs(back[2]) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0}, back));
    const Vec3d up = cross(back, right);
    const double near = size * numbers.between(0.001, 1), far = near * numbers.between(1.01, 100);
    std::array<double, 16> modelview{}, projection{};
    for (std::size_t a = 0; a < 3; ++a) {
        modelview[a * 4] = right[a];
        modelview[a * 4 + 1] = up[a];
        modelview[a * 4 + 2] = back[a];
    }
    modelview[12] = numbers.between(-size, size);
    modelview[15] = 1;
    if (numbers.below(2)) {
        projection[0] = 1.2, projection[5] = 1.8, projection[11] = -1;
        projection[10] = (far + near) / (near - far), projection[14] = 2 * far * near / (near - far);
    } else {
        projection[0] = 1 / size, projection[5] = 1.4 / size, projection[15] = 1;
        projection[10] = -2 / (far - near), projection[14] = -(far + near) / (far - near);
    }
    return Region::lasso(modelview, projection, centre, random_polygon(numbers, 1));
}

// A region of about `size` at `centre`.
Region random_region(Numbers& numbers, const Vec3d& centre, double size)
{
    const double flat = numbers.below(4) ? 1 : 0;
    const auto any_length = [&] {
        return numbers.below(2) ? std::optional(size * numbers.between(0, 3)) : std::nullopt;
    };
    switch (numbers.below(9)) {
        case 7:
            return random_prism(numbers, centre, size);
        case 8:
            return random_lasso(numbers, centre, size);
        case 0: {
            Box3d box;
            for (int k = 0; k < 2; ++k) {
                const Vec3d d = numbers.vector(size);
                box.extend(Vec3d{centre[0] + d[0], centre[1] + d[1], centre[2] + d[2]});
            }
            return Region::box(box);
        }
        case 1: {
            const Vec3d u = numbers.direction(), other = numbers.direction();
            Vec3d v = cross(u, other);
            if (length(v) < 1e-3) v = u[0] * u[0] < 0.5 ? Vec3d{0, u[2], -u[1]} : Vec3d{u[1], -u[0], 0};
            const Vec3d w = cross(u, v);
            return Region::oriented_box(centre, {u, v, w},
                                        {size * numbers.unit(), size * numbers.unit(), size * numbers.unit() * flat});
        }
        case 2:
            return Region::sphere(centre, size * numbers.unit() * flat);
        case 3: {
            std::vector<Region::Plane> planes;
            for (std::size_t n = 1 + numbers.below(12); n > 0; --n)
                planes.push_back({numbers.direction(), size * numbers.between(0, 1)});
            return Region::convex(centre, planes);
        }
        case 4: {
            Vec3d target = numbers.direction();
            for (std::size_t a = 0; a < 3; ++a) target[a] = centre[a] + size * target[a];
            const double near = size * numbers.between(0.001, 1);
            return Region::frustum(centre, target, {0.01, 0.02, 1}, numbers.between(1, 170), numbers.between(0.2, 5),
                                   near, near * numbers.between(1.01, 10));
        }
        case 5:
            return Region::ray(centre, numbers.direction(), size * numbers.unit() * flat, any_length());
        default: {
            const std::size_t edge = numbers.below(6);
            const double angle = edge == 0   ? std::pow(10, numbers.between(-12, 0))
                                 : edge == 1 ? 90 - std::pow(10, numbers.between(-12, 0))
                                             : numbers.between(1, 89);
            return Region::cone(centre, numbers.direction(), angle, any_length());
        }
    }
}

Box3d random_box(Numbers& numbers, const Region& region, double size)
{
    Vec3d from = numbers.vector(size * 2);
    if (numbers.below(3) == 0)
        for (double& c : from) c *= numbers.unit() * 0.1;
    Vec3d to = from;
    const double side = size * std::pow(10, numbers.between(-6, 1));
    for (std::size_t a = 0; a < 3; ++a)
        if (numbers.below(5)) to[a] += side * numbers.unit();
    Box3d box;
    for (const Vec3d& d : {from, to})
        box.extend(Vec3d{region.centre()[0] + d[0], region.centre()[1] + d[1], region.centre()[2] + d[2]});
    // Against the boundary: a box that begins at the bounds.
    if (numbers.below(10) == 0 && std::isfinite(region.bounds().max[0])) {
        const double moved = region.bounds().max[0] - box.min[0];
        box.min[0] += moved;
        box.max[0] += moved;
    }
    for (std::size_t a = 0; a < 3; ++a) box.max[a] = std::max(box.max[a], box.min[a]);
    return box;
}

// Corners, edges and the interior of a box.
Vec3d point_in(Numbers& numbers, const Box3d& box)
{
    Vec3d p;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t where = numbers.below(3);
        p[a] = where == 0   ? box.min[a]
               : where == 1 ? box.max[a]
                            : std::clamp(numbers.between(box.min[a], box.max[a]), box.min[a], box.max[a]);
    }
    return p;
}

TEST(Region, RelationIsNeverWrong)
{
    Numbers numbers(1);
    std::size_t inside = 0, outside = 0, crosses = 0, both_kinds = 0;
    for (int round = 0; round < 60000; ++round) {
        const double size = numbers.size();
        const Vec3d centre = numbers.below(2) ? numbers.vector(1e7) : numbers.vector(size);
        const Region region = random_region(numbers, centre, size);
        const Box3d box = random_box(numbers, region, size);
        const BoxRelation relation = region.relation(box);
        bool in = false, out = false;
        for (int k = 0; k < 24; ++k) {
            const Vec3d p = point_in(numbers, box);
            const bool contained = region.contains(p);
            (contained ? in : out) = true;
            if (contained) ASSERT_TRUE(region.bounds().contains(p)) << region.text();
            if (relation == BoxRelation::inside) ASSERT_TRUE(contained) << region.text();
            if (relation == BoxRelation::outside) ASSERT_FALSE(contained) << region.text();
        }
        inside += relation == BoxRelation::inside;
        outside += relation == BoxRelation::outside;
        crosses += relation == BoxRelation::crosses;
        both_kinds += in && out;
    }
    // And it is sharp: most boxes reported as crossing have points on both sides.
    EXPECT_GT(inside, 3000u);
    EXPECT_GT(outside, 10000u);
    EXPECT_LT(static_cast<double>(crosses), 1.3 * static_cast<double>(both_kinds));
}

// The formulas of the header in 64 bits of mantissa: no point clearly on one side is classified as being on the other.
TEST(Region, ContainsIsWhatTheFormulasGive)
{
    Numbers numbers(2);
    const auto dot = [](const Vec3d& a, const std::array<Long, 3>& d) {
        return a[0] * d[0] + a[1] * d[1] + a[2] * d[2];
    };
    std::size_t decided = 0;
    for (int round = 0; round < 40000; ++round) {
        const double size = numbers.size();
        const Vec3d centre = numbers.below(2) ? numbers.vector(1e7) : numbers.vector(size), u = numbers.direction();
        const double radius = size * numbers.unit(), angle = numbers.between(0.001, 89.999);
        Vec3d p = numbers.vector(size * 1.5);
        for (std::size_t a = 0; a < 3; ++a) p[a] += centre[a];
        std::array<Long, 3> d, w;
        for (std::size_t a = 0; a < 3; ++a) d[a] = static_cast<Long>(p[a]) - centre[a];
        const Long reach = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), margin = 0x1p-49L * reach;
        const Long length = std::sqrt(dot(u, {u[0], u[1], u[2]})), t = dot(u, d) / length;
        for (std::size_t a = 0; a < 3; ++a) w[a] = d[a] - t * u[a] / length;
        const Long across = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        const Long radians = static_cast<Long>(angle) / 180 * 3.14159265358979323846264338328L;

        const auto check = [&](const Region& region, Long excess) {
            if (std::fabs(excess) <= margin) return;
            ++decided;
            ASSERT_EQ(region.contains(p), excess < 0) << region.text();
        };
        check(Region::sphere(centre, radius), reach - radius);
        check(Region::ray(centre, u, radius), std::max(-t, across - radius));
        check(Region::ray(centre, u, radius, size), std::max({-t, t - size, across - radius}));
        check(Region::cone(centre, u, angle), std::max(-t, across * std::cos(radians) - t * std::sin(radians)));
        check(Region::cone(centre, u, angle, size),
              std::max({-t, t - size, across * std::cos(radians) - t * std::sin(radians)}));
        check(Region::convex(centre, {{u, radius}}), -(dot(u, d) + radius) / length);
    }
    EXPECT_GT(decided, 200000u);
}

TEST(Region, AnOrientedBoxIsTheBoxTurned)
{
    Numbers numbers(3);
    for (int round = 0; round < 3000; ++round) {
        const double turn = numbers.between(-200, 200), c = std::cos(turn / 180 * pi), s = std::sin(turn / 180 * pi);
        const Vec3d centre = numbers.vector(1e6), half = {numbers.unit(), numbers.unit() * 5, numbers.unit() * 2};
        const Region region =
            parse_region("oriented-box " + std::to_string(centre[0]) + " " + std::to_string(centre[1]) + " " +
                         std::to_string(centre[2]) + " " + std::to_string(half[0]) + "," + std::to_string(half[1]) +
                         " " + std::to_string(half[2]) + " " + std::to_string(turn));
        const Vec3d q = numbers.vector(6);
        const Vec3d p = {centre[0] + c * q[0] - s * q[1], centre[1] + s * q[0] + c * q[1], centre[2] + q[2]};
        double excess = -1e9;
        for (std::size_t a = 0; a < 3; ++a) excess = std::max(excess, std::fabs(q[a]) - half[a]);
        if (std::fabs(excess) < 1e-4) continue;  // the text has six digits after the point
        EXPECT_EQ(region.contains(p), excess < 0);
    }
}

TEST(Region, AFrustumIsWhatItsMatricesShow)
{
    Numbers numbers(4);
    std::size_t seen = 0;
    for (int round = 0; round < 2000; ++round) {
        // A turned, scaled view, perspective or orthographic, far from the origin of the source.
        const Vec3d origin = numbers.vector(1e7), eye = numbers.vector(50);
        const double angle = numbers.between(0, 6), c = std::cos(angle), s = std::sin(angle),
                     zoom = std::pow(10, numbers.between(-3, 3));
        std::array<double, 16> modelview{}, projection{};
        const double rows[3][3] = {{c * zoom, s * zoom, 0}, {0, 0, zoom}, {s * zoom, -c * zoom, 0}};
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t k = 0; k < 3; ++k) {
                modelview[k * 4 + r] = rows[r][k];
                modelview[12 + r] -= rows[r][k] * eye[k];
            }
        modelview[15] = 1;
        const double near = 0.1 * zoom, far = 100 * zoom;
        if (round % 2) {
            projection[0] = 1.3, projection[5] = 1.9, projection[8] = 0.1;
            projection[10] = (far + near) / (near - far), projection[14] = 2 * far * near / (near - far),
            projection[11] = -1;
        } else {
            projection[0] = 0.03 / zoom, projection[5] = 0.05 / zoom, projection[12] = 0.2;
            projection[10] = -2 / (far - near), projection[14] = -(far + near) / (far - near), projection[15] = 1;
        }
        const Region region = Region::frustum(modelview, projection, origin);
        EXPECT_TRUE(std::isfinite(region.bounds().min[0] + region.bounds().max[2]));
        for (int k = 0; k < 20; ++k) {
            Vec3d local = numbers.vector(100), p;
            for (std::size_t a = 0; a < 3; ++a) {
                p[a] = origin[a] + local[a];
                local[a] = p[a] - origin[a];
            }
            Long e[4] = {0, 0, 0, 1}, clip[4];
            for (std::size_t r = 0; r < 3; ++r)
                e[r] = static_cast<Long>(modelview[r]) * local[0] + static_cast<Long>(modelview[4 + r]) * local[1] +
                       static_cast<Long>(modelview[8 + r]) * local[2] + modelview[12 + r];
            for (std::size_t r = 0; r < 4; ++r)
                clip[r] = projection[r] * e[0] + projection[4 + r] * e[1] + projection[8 + r] * e[2] +
                          projection[12 + r] * e[3];
            Long excess = -clip[3] * 2;
            for (std::size_t r = 0; r < 3; ++r) excess = std::max(excess, std::fabs(clip[r]) - clip[3]);
            if (std::fabs(excess) < 1e-8L * (1 + std::fabs(clip[3]) + std::fabs(clip[2]))) continue;
            EXPECT_EQ(region.contains(p), excess < 0);
            seen += excess < 0;
            if (region.contains(p)) EXPECT_TRUE(region.bounds().contains(p));
        }
    }
    EXPECT_GT(seen, 1000u);
    // A camera as text and the same one as matrices.
    const Region words = parse_region("frustum 10 20 30  10 25 30  90 1 1 50");
    EXPECT_TRUE(words.contains({10, 22, 30}));
    EXPECT_TRUE(words.contains({11.9, 22, 28.1}));
    EXPECT_FALSE(words.contains({12.1, 22, 30}));
    EXPECT_FALSE(words.contains({10, 20.9, 30}));
    EXPECT_FALSE(words.contains({10, 70.1, 30}));
}

TEST(Region, TextReadsBackAsTheSameRegion)
{
    Numbers numbers(5);
    for (int round = 0; round < 3000; ++round) {
        const double size = numbers.size();
        const Region region = random_region(numbers, numbers.vector(1e6), size), again = parse_region(region.text());
        const Box3d box = random_box(numbers, region, size);
        if (region.kind() == Kind::oriented_box) {
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_NEAR(region.bounds().min[a], again.bounds().min[a], 1e-9 * size + 1e-8);
            continue;
        }
        EXPECT_EQ(region.relation(box), again.relation(box)) << region.text();
        EXPECT_EQ(region.bounds(), again.bounds()) << region.text();
        EXPECT_EQ(region.text(), again.text());
    }
}

std::string message_of(const std::function<void()>& f)
{
    try {
        f();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "accepted";
}

TEST(Region, RefusesInvalidRegions)
{
    const double nan = std::nan(""), inf = INFINITY;
    const std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    const auto expect = [](const std::string& part, const std::function<void()>& f) {
        const std::string message = message_of(f);
        EXPECT_NE(message.find(part), std::string::npos) << message;
    };
    expect("radius is -1", [] { Region::sphere({0, 0, 0}, -1); });
    expect("radius is", [&] { Region::sphere({0, 0, 0}, nan); });
    expect("centre is not finite", [&] { Region::sphere({0, inf, 0}, 1); });
    expect("NaN", [&] { Region::box({{0, nan, 0}, {1, 1, 1}}); });
    expect("axis has no length", [&] { Region::oriented_box({0, 0, 0}, {axes[0], Vec3d{}, axes[2]}, {1, 1, 1}); });
    expect("not perpendicular", [&] {
        Region::oriented_box({0, 0, 0}, {axes[0], Vec3d{1, 1, 0}, axes[2]}, {1, 1, 1});
    });
    expect("not perpendicular", [&] { Region::oriented_box({0, 0, 0}, {axes[0], axes[0], axes[2]}, {1, 1, 1}); });
    expect("centre", [&] { Region::oriented_box({0, 0, inf}, axes, {1, 1, 1}); });
    expect("half size", [&] { Region::oriented_box({0, 0, 0}, axes, {1, -1, 1}); });
    expect("0 planes", [] { Region::convex({0, 0, 0}, {}); });
    expect("normal has no length", [] { Region::convex({0, 0, 0}, {{{0, 0, 0}, 1}}); });
    expect("direction has no length", [] { Region::ray({0, 0, 0}, {0, 0, 0}, 1); });
    expect("direction is not finite", [&] { Region::ray({0, 0, 0}, {0, nan, 0}, 1); });
    expect("length is -2", [] { Region::ray({0, 0, 0}, {0, 1, 0}, 1, -2.0); });
    for (const double angle : {0.0, -3.0, 90.0, 400.0, nan})
        expect("half angle", [&] { Region::cone({0, 0, 0}, {1, 0, 0}, angle); });
    std::array<double, 16> singular{}, identity{};
    for (std::size_t k = 0; k < 4; ++k) identity[k * 5] = 1;
    singular[15] = 1;
    expect("singular", [&] { Region::frustum(singular, identity, {0, 0, 0}); });
    expect("not affine", [&] { Region::frustum({}, identity, {0, 0, 0}); });
    expect("not finite", [&] { Region::frustum({nan}, identity, {0, 0, 0}); });
    expect("parallel to the direction of view", [] { Region::frustum({0, 0, 0}, {0, 0, 9}, {0, 0, 1}, 50, 1, 1, 2); });
    expect("0 < near < far", [] { Region::frustum({0, 0, 0}, {0, 9, 0}, {0, 0, 1}, 50, 1, 2, 1); });
    expect("angle of view", [] { Region::frustum({0, 0, 0}, {0, 9, 0}, {0, 0, 1}, 180, 1, 1, 2); });

    for (const char* text : {"",
                             "  ",
                             "ball 1 2 3 4",
                             "sphere",
                             "sphere 1 2 3",
                             "sphere 1 2 3 4 5",
                             "sphere 1 2 3 x",
                             "sphere 1 2 3 4m",
                             "box 1 2 3 4 5",
                             "planes 0 0 0",
                             "planes 0 0 0 1 0 0",
                             "cone 0 0 0 1 0 0 95",
                             "ray 0 0 0 0 0 0 1",
                             "polygon 0 0 1 1",
                             "polygon 0 0 1 1 2",
                             "prism 0 0 0 1 0 0 1 0 0 0 0 1 1 2 0",
                             "lasso 0 0 1 0 1 1",
                             "polygon 0 0 1 0 1 1e160",
                             "sphere 1 2 3 nan",
                             "sphere 1 2 3 1e999",
                             "frustum 0 0 0 0 0 1 60 1 1 2"})
        EXPECT_NE(message_of([&] { parse_region(text); }), "accepted") << text;
}

TEST(Region, EdgesOfTheRange)
{
    // A point, a line, nothing.
    const Region point = Region::sphere({1e7, -1e7, 3}, 0);
    EXPECT_TRUE(point.contains({1e7, -1e7, 3}));
    EXPECT_FALSE(point.contains({1e7, std::nextafter(-1e7, 0), 3}));
    EXPECT_EQ(point.relation({{1e7, -1e7, 3}, {1e7, -1e7, 3}}), BoxRelation::inside);
    const Region line = Region::ray({0, 0, 0}, {0, 0, -5}, 0);
    EXPECT_TRUE(line.contains({0, 0, -1e9}));
    EXPECT_FALSE(line.contains({1e-9, 0, -1}));
    EXPECT_FALSE(line.contains({0, 0, 1e-9}));
    EXPECT_EQ(Region::box({}).relation({{0, 0, 0}, {1, 1, 1}}), BoxRelation::outside);
    EXPECT_FALSE(Region::box({}).contains({0, 0, 0}));
    // Points that are not finite are in no region; boxes that are not finite are never misclassified.
    const double inf = INFINITY, nan = std::nan("");
    for (const char* text : {"sphere 0 0 0 1e300", "cone 0 0 0 1 1 1 89", "ray 0 0 0 1 0 0 5", "planes 0 0 0 1 1 1 5",
                             "polygon -9 -9 9 -9 0 9", "box -1e308 -1e308 -1e308 1e308 1e308 1e308"}) {
        const Region region = parse_region(text);
        for (const double bad : {inf, -inf, nan}) EXPECT_FALSE(region.contains({bad, 0, 0})) << text;
        EXPECT_EQ(region.relation(Box3d()), BoxRelation::outside);
        EXPECT_EQ(region.relation({{-inf, -inf, -inf}, {inf, inf, inf}}), BoxRelation::crosses) << text;
    }
    // A box around a thin ray crosses it, however large; a box next to it is outside.
    const Region ray = Region::ray({500000, 4800000, 100}, {1, 1, 0}, 0.001);
    EXPECT_EQ(ray.relation({{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}}), BoxRelation::crosses);
    EXPECT_EQ(ray.relation({{500010, 4800010, 100.002}, {500020, 4800020, 200}}), BoxRelation::outside);
    EXPECT_EQ(ray.relation({{500012, 4800008, 90}, {500020, 4800011.9, 110}}), BoxRelation::outside);
    EXPECT_EQ(ray.relation({{500012, 4800008, 90}, {500020, 4800012.1, 110}}), BoxRelation::crosses);
}

// Half-spaces along the axes and along turned ones: the bounds are those of the corners, and not wider.
TEST(Region, BoundsOfPlanesAreTight)
{
    const Vec3d centre{454321, 5412345, 310}, half{2, 3, 4};
    for (const double turn : {0.0, 0.3, std::acos(0.0)}) {
        const std::array<Vec3d, 3> axes{Vec3d{std::cos(turn), std::sin(turn), 0},
                                        Vec3d{-std::sin(turn), std::cos(turn), 0}, Vec3d{0, 0, 1}};
        std::vector<Region::Plane> planes;
        for (std::size_t k = 0; k < 3; ++k)
            for (const double side : {-5.0, 0.2}) planes.push_back({side * axes[k], std::fabs(side) * half[k]});
        const Box3d bounds = Region::convex(centre, planes).bounds();
        for (std::size_t a = 0; a < 3; ++a) {
            double reach = 0;
            for (std::size_t k = 0; k < 3; ++k) reach += half[k] * std::fabs(axes[k][a]);
            EXPECT_NEAR(bounds.max[a], centre[a] + reach, 1e-6) << turn;
            EXPECT_NEAR(bounds.min[a], centre[a] - reach, 1e-6) << turn;
        }
    }
}

}  // namespace
