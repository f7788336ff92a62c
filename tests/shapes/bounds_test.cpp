#include "pcm/shapes/bounds.h"

#include "pcm/cloud/polygon.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace pcm {
namespace {

constexpr Vec3d map_origin{500000.25, 4800000.5, 100.125};
constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3d random_direction(std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    return normalised({normal(random), normal(random), normal(random)});
}

double area_about(const Vec3d& normal, const std::vector<Vec3d>& corners)
{
    double sum = 0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        sum += dot(normal, cross(corners[i] - corners[0], corners[i + 1] - corners[0]));
    return sum / 2;
}

bool turns_left_everywhere(const Vec3d& normal, const std::vector<Vec3d>& corners, double slack)
{
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d &a = corners[i], &b = corners[(i + 1) % corners.size()], &c = corners[(i + 2) % corners.size()];
        if (dot(normal, cross(b - a, c - b)) < -slack) return false;
    }
    return true;
}

// The cut by another way: a large square of the plane, clipped by the box's six sides one after the other.
std::vector<Vec3d> clipped_square(const Shape& plane, const Box3d& box)
{
    const AxisFrame frame(plane.axis);
    const double far = 4 * box.diagonal();
    const Vec3d middle = box.centre() - signed_distance(plane, box.centre()) * plane.axis;
    std::vector<Vec3d> polygon;
    for (const auto& [x, y] : {std::pair{-far, -far}, {far, -far}, {far, far}, {-far, far}})
        polygon.push_back(middle + x * frame.u + y * frame.v);
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            const double limit = side > 0 ? box.max[axis] : box.min[axis];
            std::vector<Vec3d> kept;
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
                const double from = side * (limit - a[axis]), to = side * (limit - b[axis]);
                if (from >= 0) kept.push_back(a);
                if ((from >= 0) != (to >= 0)) kept.push_back(a + from / (from - to) * (b - a));
            }
            polygon = kept;
        }
    return polygon;
}

TEST(BoundsInBox, APlaneIsCutAsByClipping)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::array<int, 7> found{};
    for (const double size : {1e-3, 1.0, 1e4})
        for (int round = 0; round < 700; ++round) {
            Box3d box;
            box.min = size * Vec3d{unit(random), unit(random), unit(random)} + map_origin;
            box.max = box.min + size * Vec3d{unit(random), unit(random), 0.01 + unit(random)};
            Shape plane;
            plane.axis = random_direction(random);
            plane.point = box.centre() + 0.3 * size * random_direction(random);
            const std::vector<Vec3d> corners = bounds_in_box(plane, box).outline;
            ++found.at(corners.size());
            const double nearness = 1e-9 * size + 4e-9;
            for (const Vec3d& p : corners) {
                EXPECT_LT(distance_to(plane, p), nearness);
                for (std::size_t a = 0; a < 3; ++a) {
                    EXPECT_GE(p[a], box.min[a]);
                    EXPECT_LE(p[a], box.max[a]);
                }
            }
            EXPECT_TRUE(turns_left_everywhere(plane.axis, corners, nearness * size));
            EXPECT_NEAR(area_about(plane.axis, corners), area_about(plane.axis, clipped_square(plane, box)),
                        nearness * size * 10);
        }
    for (const int count : {0, 3, 4, 5, 6}) EXPECT_GT(found[count], 20) << count;
    EXPECT_EQ(found[1] + found[2], 0);
}

std::size_t corners_in_unit_box(const char* plane, double from = 0, double to = 1)
{
    return bounds_in_box(parse_shape(plane), {{from, from, from}, {to, to, to}}).outline.size();
}

TEST(BoundsInBox, PlanesThroughCornersEdgesAndFaces)
{
    EXPECT_EQ(corners_in_unit_box("plane 0.5 0.5 0.5 1 1 1"), 6u);
    EXPECT_EQ(corners_in_unit_box("plane 0 0 0 1 -1 0"), 4u);  // through two edges
    EXPECT_EQ(corners_in_unit_box("plane 1 0 0 1 1 1"), 3u);   // through three corners
    EXPECT_EQ(corners_in_unit_box("plane 1 1 0 1 1 1"), 3u);   // through three corners, from the other side
    EXPECT_EQ(corners_in_unit_box("plane 0 0 0 1 1 1"), 0u);   // touches a corner
    EXPECT_EQ(corners_in_unit_box("plane 1 1 1 1 1 1"), 0u);   // touches a corner
    EXPECT_EQ(corners_in_unit_box("plane 0 0 0 1 1 0"), 0u);   // touches an edge
    EXPECT_EQ(corners_in_unit_box("plane 0 0 1.001 0 0 1"), 0u);
    for (const char* face :
         {"0 0 0 0 0 1", "0 0 1 0 0 1", "0 0 0 0 0 -1", "1 0 0 1 0 0", "1 0 0 -1 0 0", "0 1 0 0 1 0"})
        EXPECT_EQ(corners_in_unit_box((std::string("plane ") + face).c_str()), 4u) << face;
}

TEST(BoundsInBox, AFlatBoxInThePlane)
{
    Box3d box;
    box.extend(map_origin);
    box.extend(map_origin + Vec3d{3, 2, 0});
    Shape plane;
    plane.point = map_origin + Vec3d{100, 7, 0};
    for (const Vec3d& normal : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, normalised({1e-13, -1e-13, 1})}) {
        plane.axis = normal;
        const std::vector<Vec3d> corners = bounds_in_box(plane, box).outline;
        ASSERT_EQ(corners.size(), 4u);
        EXPECT_NEAR(area_about(normal, corners), 6, 1e-8);
    }
    plane.point[2] += 0.001;
    EXPECT_TRUE(bounds_in_box(plane, box).outline.empty());
}

TEST(BoundsInBox, AnAxisIsCutBySlabs)
{
    // A long thin box: the planes of its long sides cut the axis near the centre too, but outside of the box's ends.
    const Box3d box{{0, 0, 0}, {100, 1, 1}};
    const Shape along = parse_shape("cylinder 500 0.5 0.5 1 0 0 0.2");
    EXPECT_DOUBLE_EQ(bounds_in_box(along, box).from, -500);
    EXPECT_DOUBLE_EQ(bounds_in_box(along, box).to, -400);
    const Shape tilted = parse_shape("cylinder 50 0.5 0.5 1 0.001 0 0.2");
    const ShapeBounds bounds = bounds_in_box(tilted, box);
    EXPECT_NEAR(tilted.point[0] + bounds.from * tilted.axis[0], 0, 1e-12);
    EXPECT_NEAR(tilted.point[0] + bounds.to * tilted.axis[0], 100, 1e-12);
    // An axis that misses the box: its corners decide.
    const ShapeBounds beside = bounds_in_box(parse_shape("cylinder 0 -3 0 1 0 0 3.2"), box);
    EXPECT_DOUBLE_EQ(beside.from, 0);
    EXPECT_DOUBLE_EQ(beside.to, 100);
    const ShapeBounds from_outside = bounds_in_box(parse_shape("cylinder 30 -3 0 -1 0 0 3.2"), box);
    EXPECT_DOUBLE_EQ(from_outside.from, -70);
    EXPECT_DOUBLE_EQ(from_outside.to, 30);
    // Along an edge of the box.
    EXPECT_DOUBLE_EQ(bounds_in_box(parse_shape("cylinder 0 0 0 -1 0 0 3.2"), box).from, -100);
}

TEST(BoundsInBox, AConeBeginsAtItsApex)
{
    const Box3d box{{-1, -1, -1}, {1, 1, 1}};
    const ShapeBounds bounds = bounds_in_box(parse_shape("cone 0 0 0.5 0 0 -1 30"), box);
    EXPECT_DOUBLE_EQ(bounds.from, 0);
    EXPECT_DOUBLE_EQ(bounds.to, 1.5);
    const Shape away = parse_shape("cone 0 0 -2 0 0 -1 30");
    EXPECT_FALSE(bounds_in_box(away, box).known(ShapeKind::cone));
}

TEST(BoundsInBox, BoxesThatAreNone)
{
    const Shape plane = parse_shape("plane 0 0 0 0 0 1"), pipe = parse_shape("cylinder 0 0 0 0 0 1 1");
    EXPECT_FALSE(bounds_in_box(plane, {}).known(plane.kind));
    EXPECT_FALSE(bounds_in_box(pipe, {}).known(pipe.kind));
    EXPECT_THROW(bounds_in_box(plane, {{0, 0, 0}, {1, 1, infinity}}), Error);
    const Box3d point{{1, 1, 0}, {1, 1, 0}};
    EXPECT_FALSE(bounds_in_box(plane, point).known(plane.kind));
    EXPECT_FALSE(bounds_in_box(pipe, point).known(pipe.kind));
}

// Points of a plane through the map's origin, from its own coordinates.
struct OnPlane {
    explicit OnPlane(const Vec3d& normal) : frame(normal)
    {
        plane.point = map_origin + 1000 * frame.u;
        plane.axis = normal;
    }
    Vec3d at(double x, double y, double h = 0) const { return map_origin + x * frame.u + y * frame.v + h * frame.axis; }
    std::vector<Vec2d> flat(const std::vector<Vec3d>& corners) const
    {
        std::vector<Vec2d> result;
        for (const Vec3d& p : corners) result.push_back({dot(p - map_origin, frame.u), dot(p - map_origin, frame.v)});
        return result;
    }
    AxisFrame frame;
    Shape plane;
};

double area_of(const std::vector<Vec2d>& corners)
{
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return sum / 2;
}

TEST(BoundsOfPoints, TheLeastRectangleOfTurnedRectangles)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int round = 0; round < 100; ++round) {
        const OnPlane place(random_direction(random));
        const double turn = 7 * unit(random), width = 0.1 + unit(random), height = 5 * unit(random);
        std::vector<Vec3d> points;
        for (int i = 0; i < 300; ++i) {
            const double x = i < 4 ? i & 1 : unit(random), y = i < 4 ? i >> 1 : unit(random);
            points.push_back(place.at(width * x * std::cos(turn) - height * y * std::sin(turn),
                                      width * x * std::sin(turn) + height * y * std::cos(turn), 0.01 * unit(random)));
        }
        const ShapeBounds bounds = bounds_of(place.plane, points, {OutlineKind::rectangle, 0});
        ASSERT_EQ(bounds.outline.size(), 4u);
        for (const Vec3d& p : bounds.outline) EXPECT_LT(distance_to(place.plane, p), 4e-9);
        EXPECT_NEAR(area_of(place.flat(bounds.outline)), width * height, 1e-7);
    }
}

TEST(BoundsOfPoints, NoRectangleAlongAnEdgeIsSmaller)
{
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 100; ++round) {
        const OnPlane place(random_direction(random));
        std::vector<Vec3d> points;
        for (int i = 0; i < 3 + round; ++i) points.push_back(place.at(3 * normal(random), normal(random)));
        const auto hull = place.flat(bounds_of(place.plane, points, {OutlineKind::convex, 0}).outline);
        const auto rectangle = place.flat(bounds_of(place.plane, points, {OutlineKind::rectangle, 0}).outline);
        double least = infinity;
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
            const double angle = std::atan2(b[1] - a[1], b[0] - a[0]), c = std::cos(angle), s = std::sin(angle);
            Vec2d low{infinity, infinity}, high{-infinity, -infinity};
            for (const Vec2d& p : hull) {
                const Vec2d turned{p[0] * c + p[1] * s, p[1] * c - p[0] * s};
                for (std::size_t k = 0; k < 2; ++k) {
                    low[k] = std::min(low[k], turned[k]);
                    high[k] = std::max(high[k], turned[k]);
                }
            }
            least = std::min(least, (high[0] - low[0]) * (high[1] - low[1]));
        }
        EXPECT_NEAR(area_of(rectangle), least, 1e-7 * least);
        for (const Vec3d& p : points)
            for (std::size_t i = 0; i < 4; ++i) {
                const Vec2d &a = rectangle[i], &b = rectangle[(i + 1) % 4], q = place.flat({p})[0];
                EXPECT_GT((b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]), -1e-7);
            }
    }
}

TEST(BoundsOfPoints, TheConvexHullHoldsAllPointsAndIsMadeOfThem)
{
    std::mt19937_64 random(4);
    std::uniform_int_distribution<int> coarse(0, 6);
    for (int round = 0; round < 200; ++round) {
        const OnPlane place(random_direction(random));
        std::vector<Vec3d> points;
        for (int i = 0; i < 25; ++i) points.push_back(place.at(coarse(random), coarse(random)));  // many on lines
        const auto hull = place.flat(bounds_of(place.plane, points, {OutlineKind::convex, 0}).outline);
        ASSERT_GE(hull.size(), 3u);
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
            for (const Vec2d& q : place.flat(points))
                EXPECT_GT((b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]), -1e-6);
            const Vec2d& c = hull[(i + 2) % hull.size()];
            EXPECT_GT((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]), 0.5) << "a corner on a line";
        }
    }
}

// A U of squares: 0 to 10 in both directions without the slot from x 4 to 6, y 2 to 10.
bool in_the_u(double x, double y) { return !(x > 4 && x < 6 && y > 2); }

TEST(BoundsOfPoints, AConcaveOutlineFollowsASlot)
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> side(0, 10);
    const OnPlane place(random_direction(random));
    std::vector<Vec3d> scattered, gridded;
    while (scattered.size() < 40000) {
        const double x = side(random), y = side(random);
        if (in_the_u(x, y)) scattered.push_back(place.at(x, y));
    }
    for (int i = 0; i <= 200; ++i)
        for (int j = 0; j <= 200; ++j)
            if (in_the_u(i / 20.0, j / 20.0)) gridded.push_back(place.at(i / 20.0, j / 20.0));
    for (const auto& points : {scattered, gridded})
        for (const double edge : {0.0, 0.5}) {
            const auto outline = bounds_of(place.plane, points, {OutlineKind::concave, edge}).outline;
            EXPECT_NEAR(area_of(place.flat(outline)), 84, 84 * 0.02) << edge;
            EXPECT_GT(area_about(place.plane.axis, outline), 0);
        }
    // Gaps narrower than the edge are closed.
    EXPECT_GT(area_of(place.flat(bounds_of(place.plane, gridded, {OutlineKind::concave, 20}).outline)), 99.9);
}

TEST(BoundsOfPoints, ScanLinesFarApartAreNotCutIntoStrips)
{
    const OnPlane place({0, 0, 1});
    std::vector<Vec3d> points;
    for (int line = 0; line < 40; ++line)
        for (int i = 0; i < 2000; ++i) points.push_back(place.at(i * 0.005, line * 0.25 + 1e-4 * ((i * 7) % 5)));
    const auto outline = bounds_of(place.plane, points, {OutlineKind::concave, 0}).outline;
    EXPECT_NEAR(area_of(place.flat(outline)), 9.995 * 9.75, 0.1);
}

TEST(BoundsOfPoints, PointsOnALineHaveNoOutline)
{
    const OnPlane place(normalised({1, 2, 3}));
    std::vector<Vec3d> points;
    for (int i = 0; i < 50; ++i) points.push_back(place.at(i, 2 * i));
    std::vector<Vec3d> along, across;
    for (int i = 0; i < 50; ++i) along.push_back(place.at(i * i, 0));
    for (int i = 0; i < 50; ++i) across.push_back(place.at(0, i * i));
    for (const OutlineKind kind : {OutlineKind::rectangle, OutlineKind::convex, OutlineKind::concave}) {
        for (const auto& some :
             {points, along, across, std::vector<Vec3d>(7, points[3]), std::vector<Vec3d>(1, points[0])})
            try {
                bounds_of(place.plane, some, {kind, 0});
                FAIL();
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
                EXPECT_NE(std::string(error.what()).find("have no outline"), std::string::npos) << error.what();
            }
    }
    EXPECT_THROW(bounds_of(place.plane, {}, {}), Error);
    points[4][1] = std::nan("");
    EXPECT_THROW(bounds_of(place.plane, points, {}), Error);
}

std::vector<Vec3d> on_pipe(const Shape& pipe, double begin, double end, std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> angle(begin, end), along(2, 5);
    std::normal_distribution<double> noise(0, 0.001);
    const AxisFrame frame(pipe.axis);
    std::vector<Vec3d> points;
    while (points.size() < count)
        points.push_back(pipe.point + along(random) * pipe.axis +
                         (pipe.radius + noise(random)) * frame.at(angle(random)));
    return points;
}

TEST(BoundsOfPoints, TheArcAndLengthOfAPipe)
{
    Shape pipe;
    pipe.kind = ShapeKind::cylinder;
    pipe.point = map_origin;
    pipe.axis = normalised({1, -2, 0.5});
    pipe.radius = 0.3;
    const AxisFrame frame(pipe.axis);
    for (const double begin : {-3.0, -0.5, 0.5, 3.0})
        for (const double arc : {0.2, 1.5, 4.0, 5.5}) {
            const ShapeBounds bounds = bounds_of(pipe, on_pipe(pipe, begin, begin + arc, 5000, 1), {});
            EXPECT_NEAR(bounds.end - bounds.begin, arc, 0.01);
            EXPECT_NEAR(std::remainder(bounds.begin - begin, 2 * pi), 0, 0.01);
            EXPECT_EQ(bounds.zero, frame.u);
            EXPECT_NEAR(bounds.from, 2, 0.01);
            EXPECT_NEAR(bounds.to, 5, 0.01);
            EXPECT_GE(bounds.begin, 0);
        }
    for (const std::size_t count : {8u, 30u, 5000u}) {
        const ShapeBounds whole = bounds_of(pipe, on_pipe(pipe, 0, 2 * pi, count, count), {});
        EXPECT_EQ(whole.end - whole.begin, 2 * pi) << count;
    }
    // Cut by a box along its length, by its points around.
    OutlineOptions by_box;
    by_box.kind = OutlineKind::box;
    Box3d box;
    box.extend(pipe.point);
    box.extend(pipe.point + 7 * pipe.axis);
    const ShapeBounds cut = bounds_of(pipe, on_pipe(pipe, 1, 2, 5000, 1), by_box, box);
    EXPECT_NEAR(cut.to - cut.from, 7, 1e-8);
    EXPECT_NEAR(cut.end - cut.begin, 1, 0.01);
}

TEST(BoundsOfPoints, TheLengthOfAConeIsThatOfItsSurface)
{
    const Shape cone = parse_shape("cone 0 0 0 0 0 1 60");
    std::vector<Vec3d> points;
    for (int i = 0; i < 100; ++i) {
        const double t = 1 + i / 99.0, turn = i * 0.7;  // along the surface, then 0.1 off it
        const double q = t * std::sin(pi / 3) + 0.1 * std::cos(pi / 3),
                     h = t * std::cos(pi / 3) - 0.1 * std::sin(pi / 3);
        points.push_back({q * std::cos(turn), q * std::sin(turn), h});
    }
    const ShapeBounds bounds = bounds_of(cone, points, {});
    EXPECT_NEAR(bounds.from, 0.5, 1e-12);
    EXPECT_NEAR(bounds.to, 1, 1e-12);
}

TEST(BoundsOfPoints, PointsNearAnApexDoNotCloseAnArc)
{
    const Shape cone = parse_shape("cone 0 0 0 0 0 1 45");
    std::vector<Vec3d> points;
    for (int i = 0; i < 200; ++i) {
        const double turn = i / 199.0, noise = i * 0.7;
        points.push_back({std::cos(turn), std::sin(turn), 1});
        points.push_back({1e-3 * std::cos(noise), 1e-3 * std::sin(noise), 1e-3});
    }
    const ShapeBounds bounds = bounds_of(cone, points, {});
    EXPECT_NEAR(bounds.end - bounds.begin, 1, 1e-9);
    EXPECT_NEAR(bounds.from, 1e-3, 1e-9);
}

TEST(BoundsOfPoints, TheArcOfAnElbow)
{
    const Shape torus = parse_shape("torus 1 2 3 0 0 1 2 0.5");
    std::vector<Vec3d> points;
    for (int i = 0; i < 400; ++i) {
        const double turn = pi / 4 + pi / 2 * (i / 399.0), tube = i * 0.9, q = 2 + 0.5 * std::cos(tube);
        points.push_back({1 + q * std::cos(turn), 2 + q * std::sin(turn), 3 + 0.5 * std::sin(tube)});
    }
    const ShapeBounds bounds = bounds_of(torus, points, {});
    EXPECT_NEAR(bounds.end - bounds.begin, pi / 2, 1e-9);
    const Vec3d first = std::cos(bounds.begin) * bounds.zero + std::sin(bounds.begin) * cross(torus.axis, bounds.zero);
    EXPECT_NEAR(first[0], std::cos(pi / 4), 1e-9);
    EXPECT_NEAR(first[1], std::sin(pi / 4), 1e-9);
}

TEST(BoundsOfPoints, SizesFromTinyToHuge)
{
    const Shape plane = parse_shape("plane 0 0 0 1 2 3");
    const AxisFrame frame(plane.axis);
    for (const double size : {1e-140, 1e-6, 1.0, 1e9, 1e100}) {
        std::vector<Vec3d> points;
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j <= 10; ++j) points.push_back(size * (0.05 * i * frame.u + 0.1 * j * frame.v));
        for (const OutlineKind kind : {OutlineKind::rectangle, OutlineKind::convex, OutlineKind::concave}) {
            const ShapeBounds bounds = bounds_of(plane, points, {kind, 0});
            EXPECT_NEAR(area_about(plane.axis, bounds.outline) / size / size, 1, 1e-6) << size << " " << name_of(kind);
        }
    }
}

TEST(BoundsOfPoints, NumbersThatOverflowAreRefusedOrNotKnown)
{
    const std::vector<Vec3d> far{
        {1e300, 0, 0}, {0, 1e300, 0}, {-1.7e308, 0, 0}, {0, 0, 1.7e308}, {1.7e308, 1.7e308, 0}};
    Box3d box;
    for (const Vec3d& p : far) box.extend(p);
    box.extend(Vec3d{-1.7e308, -1.7e308, -1.7e308});
    for (const OutlineKind kind : {OutlineKind::rectangle, OutlineKind::convex, OutlineKind::concave})
        EXPECT_THROW(bounds_of(parse_shape("plane 0 0 0 0 0 1"), far, {kind, 0}), Error);
    for (const char* text :
         {"plane 0 0 0 1 2 3", "cylinder 0 0 0 1 2 3 1", "cone 0 0 0 1 2 3 30", "torus 0 0 0 1 2 3 2 1"}) {
        const Shape shape = parse_shape(text);
        OutlineOptions options;
        options.kind = OutlineKind::box;
        for (const ShapeBounds& bounds : {bounds_in_box(shape, box), bounds_of(shape, far, options, box)}) {
            for (const Vec3d& p : bounds.outline) EXPECT_TRUE(is_finite(p)) << text;
            for (const double x : {bounds.from, bounds.to, bounds.begin, bounds.end})
                EXPECT_TRUE(std::isfinite(x)) << text;
        }
    }
}

}  // namespace
}  // namespace pcm
