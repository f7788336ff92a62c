// The numbers of measures against long double arithmetic and generated truth, at map offsets and other extremes.
#include "pcm/measure/measure.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace {

using namespace pcm;
using Long = long double;
using Vec3l = std::array<Long, 3>;
constexpr Long long_pi = 3.14159265358979323846264338327950288L;

Vec3l difference(const Vec3d& a, const Vec3d& b) { return {Long(a[0]) - b[0], Long(a[1]) - b[1], Long(a[2]) - b[2]}; }
Vec3l crossed(const Vec3l& a, const Vec3l& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Long dotted(const Vec3l& a, const Vec3l& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Long norm(const Vec3l& a) { return std::sqrt(dotted(a, a)); }

Measure measure_at(MeasureKind kind, const std::vector<Vec3d>& positions, double spacing = 0, double step = 0)
{
    Measure measure;
    measure.kind = kind;
    for (const Vec3d& p : positions) measure.points.push_back({p, spacing, step, ""});
    return measure;
}

MeasureValue value_of(const Measure& measure, const std::string& name)
{
    for (const MeasureValue& value : values_of(measure))
        if (value.name == name) return value;
    ADD_FAILURE() << "no value '" << name << "'";
    return {};
}

bool has_value(const Measure& measure, const std::string& name)
{
    for (const MeasureValue& value : values_of(measure))
        if (value.name == name) return true;
    return false;
}

std::string refusal(const Measure& measure)
{
    try {
        values_of(measure);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "not refused";
}

void expect_relative(double value, Long expected, double tolerance, const std::string& what)
{
    EXPECT_LE(std::fabs(Long(value) - expected), tolerance * std::fabs(expected))
        << what << ": " << value << ", expected " << double(expected);
}

// Clouds' places and sizes: near the origin, map coordinates, the whole earth, microns, millimetres at map coordinates.
struct Place {
    Vec3d origin;
    double size;
};
const Place places[] = {{{0, 0, 0}, 1},
                        {{500000.123, 4800000.456, 100.789}, 80},
                        {{5e6, -9e6, 8e3}, 1e-3 * 50},
                        {{0, 0, 0}, 1e-6},
                        {{-1e9, 1e9, 0}, 1e9}};

std::vector<Vec3d> random_points(std::mt19937_64& random, const Place& place, std::size_t count)
{
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < count; ++i) {
        Vec3d p;
        for (std::size_t a = 0; a < 3; ++a) p[a] = place.origin[a] + place.size * unit(random);
        points.push_back(p);
    }
    return points;
}

TEST(Measure, DistanceIsThatOfLongDouble)
{
    std::mt19937_64 random(1);
    for (const Place& place : places) {
        for (int round = 0; round < 200; ++round) {
            const std::vector<Vec3d> p = random_points(random, place, 2 + static_cast<std::size_t>(round) % 5);
            Long total = 0, horizontal = 0;
            for (std::size_t i = 1; i < p.size(); ++i) {
                Vec3l d = difference(p[i], p[i - 1]);
                total += norm(d);
                d[2] = 0;
                horizontal += norm(d);
            }
            const Long vertical = difference(p.back(), p.front())[2];
            const Measure measure = measure_at(MeasureKind::distance, p);
            expect_relative(value_of(measure, "distance").value, total, 1e-12, "distance");
            expect_relative(value_of(measure, "horizontal").value, horizontal, 1e-12, "horizontal");
            expect_relative(value_of(measure, "vertical").value, vertical, 1e-12, "vertical");
            expect_relative(value_of(measure, "slope").value, 100 * vertical / horizontal, 1e-12, "slope");
            expect_relative(value_of(measure, "slope angle").value, 180 / long_pi * std::atan2(vertical, horizontal),
                            1e-12, "slope angle");
            EXPECT_EQ(has_value(measure, "direct"), p.size() > 2);
            if (p.size() > 2)
                expect_relative(value_of(measure, "direct").value, norm(difference(p.back(), p.front())), 1e-12,
                                "direct");
        }
    }
}

TEST(Measure, SlopeOfVerticalAndNoLine)
{
    const Measure up = measure_at(MeasureKind::distance, {{1, 2, 3}, {1, 2, 5}}, 0.1);
    EXPECT_FALSE(has_value(up, "slope"));
    EXPECT_EQ(value_of(up, "slope angle").value, 90);
    EXPECT_GT(value_of(up, "slope angle").uncertainty, 0);
    const Measure down = measure_at(MeasureKind::distance, {{1, 2, 5}, {1, 2, 3}, {1, 2, 1}});
    EXPECT_EQ(value_of(down, "slope angle").value, -90);
    const Measure none = measure_at(MeasureKind::distance, {{1, 2, 3}, {1, 2, 3}}, 0.4);
    EXPECT_EQ(value_of(none, "distance").value, 0);
    EXPECT_NEAR(value_of(none, "distance").uncertainty, 0.1 * std::sqrt(2), 1e-15);
    EXPECT_FALSE(has_value(none, "slope angle"));
}

TEST(Measure, HeightIsSigned)
{
    const Measure measure = measure_at(MeasureKind::height, {{500000, 4800000, 112.25}, {500003, 4800004, 100.125}});
    EXPECT_EQ(value_of(measure, "height").value, -12.125);
    EXPECT_EQ(value_of(measure, "horizontal").value, 5);
}

// The truth is the angle between the doubles, not what they were made of.
TEST(Measure, AngleIsThatOfLongDoubleNearNoneAndStraightToo)
{
    std::mt19937_64 random(2);
    for (const Place& place : places) {
        for (const double opening : {1.0, 1e-3, 1e-6, 1e-8}) {
            for (int round = 0; round < 100; ++round) {
                std::vector<Vec3d> p = random_points(random, place, 3);
                // The third point nearly on the line through the first two, on either side of the second.
                const double side = round % 2 ? 1 : -1;
                for (std::size_t a = 0; a < 3; ++a)
                    p[2][a] = p[1][a] + side * (p[0][a] - p[1][a]) + opening * (p[2][a] - p[1][a]);
                const Vec3l a = difference(p[0], p[1]), b = difference(p[2], p[1]);
                const Long angle = std::atan2(norm(crossed(a, b)), dotted(a, b));
                const double value = value_of(measure_at(MeasureKind::angle, p), "angle").value;
                const Long off = std::fabs(Long(value) - 180 / long_pi * angle);
                EXPECT_LE(off, 1e-9 * double(180 / long_pi * angle)) << value;
            }
        }
    }
    EXPECT_EQ(value_of(measure_at(MeasureKind::angle, {{1, 0, 0}, {0, 0, 0}, {0, 0, 5}}), "angle").value, 90);
    EXPECT_EQ(value_of(measure_at(MeasureKind::angle, {{1, 0, 0}, {0, 0, 0}, {2, 0, 0}}), "angle").value, 0);
    EXPECT_EQ(value_of(measure_at(MeasureKind::angle, {{1, 0, 0}, {0, 0, 0}, {-2, 0, 0}}), "angle").value, 180);
    for (const double leg : {1e-320, 1e-200, 1e-100, 1e100}) {  // squares underflow or overflow
        const MeasureValue right =
            value_of(measure_at(MeasureKind::angle, {{leg, 0, 0}, {0, 0, 0}, {0, 0, 5 * leg}}), "angle");
        EXPECT_EQ(right.value, 90) << leg;
        EXPECT_EQ(right.uncertainty, 0) << leg;
        const Measure slope = measure_at(MeasureKind::distance, {{0, 0, 0}, {leg, 0, leg}});
        EXPECT_NEAR(value_of(slope, "slope").value, 100, 1e-9) << leg;
        EXPECT_EQ(value_of(slope, "slope").uncertainty, 0) << leg;
    }
    const Measure plan = measure_at(MeasureKind::angle, {{1, 0, 9}, {0, 0, 0}, {0, 1, 2}});
    EXPECT_EQ(value_of(plan, "plan angle").value, 90);
    EXPECT_FALSE(has_value(measure_at(MeasureKind::angle, {{1, 0, 0}, {0, 0, 0}, {0, 0, 5}}), "plan angle"));
}

Long long_plan_area(const std::vector<Vec3d>& p)
{
    Long sum = 0;
    for (std::size_t i = 1; i + 1 < p.size(); ++i)
        sum += crossed(difference(p[i], p[0]), difference(p[i + 1], p[0]))[2];
    return std::fabs(sum) / 2;
}

// A star around a centre: never crosses itself.
std::vector<Vec3d> star(std::mt19937_64& random, const Place& place, std::size_t count, const Vec3d& u, const Vec3d& v)
{
    std::uniform_real_distribution<double> unit(0.3, 1);
    std::vector<Vec3d> p;
    for (std::size_t i = 0; i < count; ++i) {
        const double t = 2 * pi * static_cast<double>(i) / static_cast<double>(count), r = place.size * unit(random);
        Vec3d q;
        for (std::size_t a = 0; a < 3; ++a) q[a] = place.origin[a] + r * (std::cos(t) * u[a] + std::sin(t) * v[a]);
        p.push_back(q);
    }
    return p;
}

TEST(Measure, AreasAreThoseOfLongDouble)
{
    std::mt19937_64 random(3);
    for (const Place& place : places) {
        for (std::size_t count = 3; count < 60; count += 7) {
            const std::vector<Vec3d> p = star(random, place, count, {0.8, 0, 0.6}, {0, 1, 0});
            Vec3l area{};
            Long edge = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const Vec3l part = crossed(difference(p[i], p[0]), difference(p[(i + 1) % count], p[0]));
                for (std::size_t a = 0; a < 3; ++a) area[a] += part[a] / 2;
                edge += norm(difference(p[(i + 1) % count], p[i]));
            }
            const Measure measure = measure_at(MeasureKind::area, p);
            expect_relative(value_of(measure, "plan area").value, long_plan_area(p), 1e-12, "plan area");
            expect_relative(value_of(measure, "true area").value, norm(area), 1e-12, "true area");
            expect_relative(value_of(measure, "perimeter").value, edge, 1e-12, "perimeter");
            EXPECT_NEAR(value_of(measure, "plan area").value, 0.8 * value_of(measure, "true area").value,
                        1e-5 * value_of(measure, "true area").value);
        }
    }
}

TEST(Measure, TheTrueAreaComesFirstOnSteepPlanes)
{
    for (const bool downwards : {false, true}) {
        // A leaning wall of 3 x 4, whose upper edge is `in` farther in plan: steeper than 60 degrees for in < 2.
        const auto first = [&](double in) {
            const double up = std::sqrt(16 - in * in);
            std::vector<Vec3d> wall{{0, 0, 0}, {3, 0, 0}, {3, in, up}, {0, in, up}};
            if (downwards) std::reverse(wall.begin(), wall.end());
            return values_of(measure_at(MeasureKind::area, wall))[0];
        };
        EXPECT_EQ(first(1.99).name, "true area");
        EXPECT_NEAR(first(1.99).value, 12, 1e-12);
        EXPECT_EQ(first(2.01).name, "plan area");
        EXPECT_NEAR(first(2.01).value, 3 * 2.01, 1e-12);
    }
}

TEST(Measure, AreaOfAWallHasNoPlanArea)
{
    const std::vector<Vec3d> wall{{0, 0, 0}, {3, 4, 0}, {3, 4, 2}, {0, 0, 2}};
    const Measure measure = measure_at(MeasureKind::area, wall);
    EXPECT_FALSE(has_value(measure, "plan area"));
    EXPECT_EQ(values_of(measure)[0].name, "true area");
    EXPECT_EQ(values_of(measure)[0].value, 10);
    EXPECT_EQ(value_of(measure, "perimeter").value, 14);
    EXPECT_LT(value_of(measure, "off plane").value, 1e-15);
}

TEST(Measure, AreaOfAWarpedSquare)
{
    // Corners 0.1 above and below the plane in turn: the vector area is that of the square seen from above.
    const Measure measure = measure_at(MeasureKind::area, {{0, 0, 0.1}, {1, 0, -0.1}, {1, 1, 0.1}, {0, 1, -0.1}});
    EXPECT_NEAR(value_of(measure, "true area").value, 1, 1e-15);
    EXPECT_NEAR(value_of(measure, "off plane").value, 0.1, 1e-15);
}

TEST(Measure, PolygonsThatCrossOrHaveNoAreaAreRefused)
{
    const auto area = [](const std::vector<Vec3d>& p) { return refusal(measure_at(MeasureKind::area, p)); };
    EXPECT_NE(area({{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 3, 0}}).find("crosses"), std::string::npos);
    EXPECT_NE(area({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}}).find("no area"), std::string::npos);  // equal lobes
    EXPECT_NE(area({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}).find("no area"), std::string::npos);
    EXPECT_NE(area({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}).find("no area"), std::string::npos);
    EXPECT_NE(area({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}).find("touches"), std::string::npos);
    // A spike that runs back on its edge.
    EXPECT_NE(area({{0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {2, 3, 0}}).find("touches"), std::string::npos);
    // The same crossing far away, on a tilted plane.
    EXPECT_NE(area({{5e6, 4e6, 0}, {5e6 + 4, 4e6 + 4, 4}, {5e6 + 4, 4e6, 4}, {5e6, 4e6 + 3, 0}}).find("crosses"),
              std::string::npos);
    // Points that repeat are none.
    EXPECT_EQ(
        value_of(measure_at(MeasureKind::area, {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}}),
                 "true area")
            .value,
        1);
    // A thin line at map coordinates: its area is what rounding to double makes of it.
    const Vec3d at{4999999.3, 4800000.7, 100.1};
    std::vector<Vec3d> line;
    for (const double t : {0.0, 0.3, 0.7, 1.0})
        line.push_back({at[0] + t * 12.34567, at[1] + t * 7.654321, at[2] + t * 3.3333333});
    EXPECT_NE(area(line).find("no area"), std::string::npos);
    // But a triangle with 1 mm sides there has one.
    EXPECT_NEAR(value_of(measure_at(MeasureKind::area,
                                    {{at[0], at[1], 0}, {at[0] + 0.001, at[1], 0}, {at[0], at[1] + 0.001, 0}}),
                         "plan area")
                    .value,
                5e-7, 1e-12);
}

TEST(Measure, PlaneThroughPoints)
{
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(-1, 1);
    const Vec3d n{2.0 / 7, 3.0 / 7, 6.0 / 7}, u{6.0 / 7, 2.0 / 7, -3.0 / 7}, v{-3.0 / 7, 6.0 / 7, -2.0 / 7};
    for (const Place& place : places) {
        const double ulp = std::max(largest_magnitude(place.origin), place.size) * 2.3e-16;
        for (std::size_t count = 3; count < 50; count += 4) {
            const double height = place.size * (0.5 + std::fabs(unit(random)));
            const auto at = [&](double x, double y, double z) {
                Vec3d p;
                for (std::size_t a = 0; a < 3; ++a)
                    p[a] = place.origin[a] + place.size * (x * u[a] + y * v[a]) + z * n[a];
                return p;
            };
            std::vector<Vec3d> p{at(0.1, 0.2, -height)};
            for (std::size_t i = 0; i < count; ++i) {
                const double t = 2 * pi * static_cast<double>(i) / static_cast<double>(count);
                p.push_back(at(std::cos(t) + 0.1 * unit(random), std::sin(t), 0));
            }
            const Measure measure = measure_at(MeasureKind::plane, p);
            EXPECT_NEAR(value_of(measure, "distance").value, height, 1e-12 * place.size + 16 * ulp);
            EXPECT_EQ(has_value(measure, "residual"), count > 3);
        }
    }
    const auto plane = [](const std::vector<Vec3d>& p) { return refusal(measure_at(MeasureKind::plane, p)); };
    EXPECT_NE(plane({{9, 9, 9}, {0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).find("on a line"), std::string::npos);
    EXPECT_NE(plane({{9, 9, 9}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}).find("on a line"), std::string::npos);
    EXPECT_NE(plane({{9, 9, 9}, {5e6, 4e6, 0}, {5e6 + 0.1, 4e6 + 0.3, 1}, {5e6 + 0.2, 4e6 + 0.6, 2}}).find("on a line"),
              std::string::npos);
}

// Least squares against the smallest eigenvector found by brute force over directions.
TEST(Measure, PlaneIsThatOfLeastSquares)
{
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::vector<Vec3d> p{{0.3, 0.4, 5}};
    for (int i = 0; i < 40; ++i) p.push_back({3 * normal(random), normal(random), 0.2 * normal(random)});
    const Measure measure = measure_at(MeasureKind::plane, p);
    Vec3d mean{};
    for (std::size_t i = 1; i < p.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) mean[a] += p[i][a] / 40;
    const auto squares = [&](double s, double t) {
        const double w = 1 / std::sqrt(1 + s * s + t * t);
        double sum = 0;
        for (std::size_t i = 1; i < p.size(); ++i) {
            const double d = w * (s * (p[i][0] - mean[0]) + t * (p[i][1] - mean[1]) + (p[i][2] - mean[2]));
            sum += d * d;
        }
        return sum;
    };
    double s = 0, t = 0;
    for (double step = 0.1; step > 1e-10;) {
        double best = squares(s, t), ds = 0, dt = 0;
        for (const double i : {-step, 0.0, step})
            for (const double j : {-step, 0.0, step})
                if (squares(s + i, t + j) < best) best = squares(s + i, t + j), ds = i, dt = j;
        if (ds == 0 && dt == 0) step /= 2;
        s += ds, t += dt;
    }
    const double w = 1 / std::sqrt(1 + s * s + t * t);
    EXPECT_NEAR(value_of(measure, "distance").value,
                std::fabs(w * (s * (p[0][0] - mean[0]) + t * (p[0][1] - mean[1]) + (p[0][2] - mean[2]))), 1e-6);
    EXPECT_NEAR(value_of(measure, "residual").value, std::sqrt(squares(s, t) / 40), 1e-9);
}

TEST(Measure, DistanceToSurfaces)
{
    const auto distance = [](const std::string& surface, const Vec3d& p) {
        Measure measure = measure_at(MeasureKind::surface, {p}, 0.4);
        measure.surface = parse_shape(surface);
        EXPECT_NEAR(value_of(measure, "distance").uncertainty, 0.1, 1e-15);
        return value_of(measure, "distance").value;
    };
    EXPECT_EQ(distance("plane 1 2 3 0 0 -5", {9, 9, 1}), 2);
    EXPECT_EQ(distance("plane 1 2 3, 0 0 5", {9, 9, 1}), 2);
    EXPECT_EQ(distance("sphere 0 0 0 2", {3, 4, 0}), 3);
    EXPECT_EQ(distance("sphere 0 0 0 9", {3, 4, 0}), 4);  // inside
    EXPECT_EQ(distance("cylinder 1 1 0 0 0 7 2", {4, 5, 100}), 3);
    EXPECT_EQ(distance("cylinder 1 1 0 0 0 7 6", {4, 5, -100}), 1);
    // Far out, 1 mm from a tilted plane through a map coordinate.
    EXPECT_NEAR(distance("plane 5000000 4800000 100 2 3 6", {5000002.0, 4800003.0, 106.0}), 7, 1e-12);
    for (const char* text : {"", "cone 1 2 3 4", "cone 0 0 0 0 0 1 90", "torus 0 0 0 0 0 1 1 2", "cube 1 2 3",
                             "plane 1 2 3 4 5", "plane 1 2 3 4 5 6 7", "plane 1 2 3 4 5 x", "plane 1 2 3 0 0 0",
                             "sphere 0 0 0 0", "sphere 0 0 0 -1", "cylinder 0 0 0 0 0 0 1", "sphere nan 0 0 1"})
        EXPECT_THROW(parse_shape(text), Error) << text;
    EXPECT_NEAR(distance("cone 1 2 3 0 0 1 45", {1, 3, 3}), std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(distance("cone 1 2 3 0 0 1 45", {1, 2, 4}), std::sqrt(0.5), 1e-15);  // inside
    EXPECT_EQ(distance("torus 0 0 0 0 0 2 5 1", {0, 9, 0}), 3);
    EXPECT_EQ(distance("torus 0 0 0 0 0 2 5 1", {5, 0, 0}), 1);  // inside
    EXPECT_NE(refusal(measure_at(MeasureKind::surface, {{1, 2, 3}})).find("no surface"), std::string::npos);
}

TEST(Measure, WrongNumbersOfPointsAndOfCoordinates)
{
    for (std::size_t k = 0; k < measure_kinds; ++k) {
        const auto kind = static_cast<MeasureKind>(k);
        EXPECT_EQ(measure_kind(name_of(kind)), kind);
        const PointNumbers numbers = point_numbers(kind);
        std::vector<Vec3d> p(numbers.least - 1, Vec3d{1, 2, 3});
        EXPECT_NE(refusal(measure_at(kind, p)).find("takes " + std::to_string(numbers.least)), std::string::npos);
        if (numbers.most < 100) {
            p.resize(numbers.most + 1);
            EXPECT_NE(refusal(measure_at(kind, p)).find("not " + std::to_string(numbers.most + 1)), std::string::npos);
        }
        p.assign(numbers.least, {1, 2, 3});
        p.back()[1] = std::numeric_limits<double>::quiet_NaN();
        EXPECT_NE(refusal(measure_at(kind, p)).find("not finite"), std::string::npos) << name_of(kind);
        p.back()[1] = std::numeric_limits<double>::infinity();
        EXPECT_NE(refusal(measure_at(kind, p)).find("not finite"), std::string::npos) << name_of(kind);
    }
    EXPECT_FALSE(measure_kind("length"));
    EXPECT_NE(refusal(measure_at(MeasureKind::angle, {{1, 1, 1}, {1, 1, 1}, {2, 2, 2}})).find("first"),
              std::string::npos);
    EXPECT_NE(refusal(measure_at(MeasureKind::angle, {{0, 1, 1}, {1, 1, 1}, {1, 1, 1}})).find("third"),
              std::string::npos);
    EXPECT_NE(refusal(measure_at(MeasureKind::profile, {{0, 1, 1}, {0, 1, 5}})).find("no length in plan"),
              std::string::npos);
    EXPECT_NE(refusal(measure_at(MeasureKind::volume, {{0, 1, 1}, {0, 1, 5}, {2, 1, 3}})).find("no area in plan"),
              std::string::npos);
}

// Every uncertainty against numbers of points moved at random by what is promised of them.
TEST(Measure, UncertaintiesAreTheSpreadOfMovedPoints)
{
    struct Case {
        MeasureKind kind;
        std::vector<Vec3d> points;
    };
    const Vec3d o{500000, 4800000, 100};
    const auto at = [&](double x, double y, double z) { return o + Vec3d{x, y, z}; };
    const Case cases[] = {
        {MeasureKind::distance, {at(0, 0, 0), at(3, 4, 2), at(6, 3, 1), at(9, 9, 5)}},
        {MeasureKind::height, {at(0, 0, 0), at(3, 4, 2)}},
        {MeasureKind::angle, {at(3, 0, 0.5), at(0, 0, 0), at(2, 5, 1)}},
        {MeasureKind::angle, {at(3, 0, 0), at(0, 0, 0), at(-2, 5, 0)}},
        {MeasureKind::area, {at(0, 0, 0), at(5, 0, 1), at(6, 4, 2), at(2, 5, 1), at(-1, 2, 0)}},
        {MeasureKind::plane, {at(1, 1, 6), at(0, 0, 0), at(5, 0, 1), at(6, 4, 2)}},
        {MeasureKind::plane, {at(1, 9, 6), at(0, 0, 0), at(5, 0, 0), at(5, 5, 0), at(0, 5, 0), at(2, 3, 0)}},
    };
    std::mt19937_64 random(6);
    std::normal_distribution<double> normal;
    for (const Case& one : cases) {
        Measure measure = measure_at(one.kind, one.points);
        for (std::size_t i = 0; i < measure.points.size(); ++i) {
            measure.points[i].spacing = 0.004 * static_cast<double>(1 + i);
            measure.points[i].grid_step = 0.001;
        }
        const std::vector<MeasureValue> expected = values_of(measure);
        std::vector<double> sum(expected.size()), squares(expected.size());
        constexpr int rounds = 4000;
        for (int round = 0; round < rounds; ++round) {
            Measure moved = measure;
            for (MeasuredPoint& point : moved.points)
                for (double& x : point.position) x += std::sqrt(point.variance()) * normal(random);
            const std::vector<MeasureValue> values = values_of(moved);
            for (std::size_t k = 0; k < values.size(); ++k) {
                const double off = values[k].value - expected[k].value;
                sum[k] += off;
                squares[k] += off * off;
            }
        }
        for (std::size_t k = 0; k < expected.size(); ++k) {
            if (expected[k].name == "off plane" || expected[k].name == "residual") continue;
            const double spread = std::sqrt(squares[k] / rounds - std::pow(sum[k] / rounds, 2));
            // The spread of 4000 numbers is known to 1 / sqrt(8000): 5 % are four times that.
            EXPECT_NEAR(expected[k].uncertainty, spread, 0.05 * spread) << name_of(one.kind) << " " << expected[k].name;
        }
    }
}

TEST(Measure, UncertaintyOfAPoint)
{
    const Measure measure = measure_at(MeasureKind::point, {{1, 2, 3}}, 0.4, 0.12);
    EXPECT_NEAR(value_of(measure, "z").uncertainty, std::sqrt(0.01 + 0.0012), 1e-15);
    EXPECT_EQ(value_of(measure, "y").value, 2);
}

TEST(Measure, StraightAnglesHaveUncertainties)
{
    // At 180 degrees the middle point moves the angle by both legs, at 0 by their difference.
    const double sigma = 0.1;
    const Measure straight = measure_at(MeasureKind::angle, {{-2, 0, 0}, {0, 0, 0}, {2, 0, 0}}, 4 * sigma);
    EXPECT_NEAR(value_of(straight, "angle").uncertainty, 180 / pi * sigma * std::sqrt(0.25 + 0.25 + 1), 1e-9);
    const Measure none = measure_at(MeasureKind::angle, {{2, 0, 0}, {0, 0, 0}, {2, 0, 0}}, 4 * sigma);
    EXPECT_NEAR(value_of(none, "angle").uncertainty, 180 / pi * sigma * std::sqrt(0.25 + 0.25), 1e-9);
}

TEST(Measure, ComputedNumbersComeFirst)
{
    Measure measure = measure_at(MeasureKind::volume, {{0, 0, 0}, {4, 0, 9}, {4, 3, 1}});
    EXPECT_EQ(values_of(measure)[0].name, "plan area");
    measure.computed = {{"fill", 12, 0.5, "^3"}};
    EXPECT_EQ(values_of(measure)[0].name, "fill");
    EXPECT_EQ(value_of(measure, "plan area").value, 6);
    EXPECT_EQ(value_of(measure_at(MeasureKind::profile, {{0, 0, 0}, {3, 4, 9}, {3, 5, 1}}), "length").value, 6);
}

}  // namespace
