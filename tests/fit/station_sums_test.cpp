// What shifted stations do to a fit, against matrices that are computed by hand, and against fits of shifted points.
#include "pcm/fit/station_sums.h"

#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/fit/working_points.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

using Rows = std::vector<std::vector<double>>;

Rows zeros(std::size_t rows, std::size_t columns) { return Rows(rows, std::vector<double>(columns, 0.0)); }

Rows product(const Rows& a, const Rows& b)
{
    Rows c = zeros(a.size(), b[0].size());
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t k = 0; k < b.size(); ++k)
            for (std::size_t j = 0; j < b[0].size(); ++j) c[i][j] += a[i][k] * b[k][j];
    return c;
}

Rows turned(const Rows& a)
{
    Rows b = zeros(a[0].size(), a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < a[0].size(); ++j) b[j][i] = a[i][j];
    return b;
}

// By Gauss and Jordan with pivots; `log_determinant` of a positive one.
Rows inverse(Rows a, double* log_determinant = nullptr)
{
    const std::size_t n = a.size();
    Rows b = zeros(n, n);
    double logs = 0;
    for (std::size_t i = 0; i < n; ++i) b[i][i] = 1;
    for (std::size_t c = 0; c < n; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c; r < n; ++r)
            if (std::fabs(a[r][c]) > std::fabs(a[pivot][c])) pivot = r;
        std::swap(a[c], a[pivot]);
        std::swap(b[c], b[pivot]);
        const double by = a[c][c];
        logs += std::log(std::fabs(by));
        for (std::size_t j = 0; j < n; ++j) a[c][j] /= by, b[c][j] /= by;
        for (std::size_t r = 0; r < n; ++r) {
            if (r == c) continue;
            const double times = a[r][c];
            for (std::size_t j = 0; j < n; ++j) a[r][j] -= times * a[c][j], b[r][j] -= times * b[c][j];
        }
    }
    if (log_determinant) *log_determinant = logs;
    return b;
}

// Points of a ball at map coordinates, each station on its side of it, as far out as noise and shifts put them. The
// derivatives of |p - c| - r by centre and radius are -n and -1.
struct Ball {
    explicit Ball(double noise, const std::vector<Vec3d>& shifts, std::size_t each = 25)
    {
        shape.kind = ShapeKind::sphere;
        shape.point = {454321, 5412345, 310};
        shape.radius = 0.2;
        Dice dice(7);
        for (std::uint32_t s = 0; s < shifts.size(); ++s) {
            const Vec3d side = normalised({std::cos(2.0 * s), std::sin(2.0 * s), 0.3});
            for (std::size_t i = 0; i < each;) {
                const Vec3d n = dice.direction();
                if (dot(n, side) < 0.1) continue;
                points.push_back(shape.point + (shape.radius + noise * dice.normal()) * n + shifts[s]);
                stations.push_back(s + 3);
                ++i;
            }
        }
        for (const Vec3d& p : points) {
            const Vec3d n = normal_at(shape, p);
            normals.push_back(n);
            distances.push_back({signed_distance(shape, p)});
            j.push_back({-n[0], -n[1], -n[2], -1});
            z.push_back(std::vector<double>(3 * shifts.size(), 0.0));
            for (std::size_t a = 0; a < 3; ++a) z.back()[3 * (stations[z.size() - 1] - 3) + a] = n[a];
        }
    }
    StationSums sums() const
    {
        StationSums first(shape, shape.point + Vec3d{0.05, 0, 0.02}, 0.5), second = first;
        for (std::size_t i = 0; i < points.size(); ++i) (i % 3 ? first : second).add(points[i], stations[i]);
        first.add(second);
        return first;
    }
    pcm::Shape shape;
    std::vector<Vec3d> points, normals;
    std::vector<std::uint32_t> stations;
    Rows distances, j, z;
};

const std::vector<Vec3d> three_shifts{{0.002, -0.001, 0.0005}, {-0.0015, 0.001, 0.002}, {0.001, 0.0025, -0.001}};

TEST(StationSums, ErrorsAreTheSandwichByClusterOfTheShifts)
{
    const Ball ball(0.0015, three_shifts);
    const double spread = 0.0013;
    const Rows inner = inverse(product(turned(ball.j), ball.j)), g = product(turned(ball.j), ball.z);
    const Rows covariance = product(product(inner, product(g, turned(g))), inner);
    SquareMatrix<3> place{};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) place[a][b] = covariance[a][b];
    const StationSums sums = ball.sums();
    EXPECT_EQ(sums.stations(), 3u);
    EXPECT_EQ(sums.points(), 75u);
    ASSERT_TRUE(sums.is_determined());
    const ShapeErrors errors = sums.errors_of({spread, 0});
    EXPECT_NEAR(errors.radius, spread * std::sqrt(covariance[3][3]), 1e-5 * errors.radius);
    EXPECT_NEAR(errors.position, spread * std::sqrt(eigensystem<3>(place).values[2]), 1e-5 * errors.position);
    EXPECT_EQ(errors.angle, 0);
    EXPECT_EQ(errors.second, 0);
}

TEST(StationSums, OneStationShiftsAShapeAndLeavesItsSize)
{
    const Ball ball(0.001, {{0.001, 0.002, -0.001}});
    const ShapeErrors errors = ball.sums().errors_of({0.002, 0});
    EXPECT_NEAR(errors.position, 0.002, 1e-8);
    EXPECT_LT(errors.radius, 1e-8);
    EXPECT_EQ(ball.sums().evidence(0.001).spread().freedom, 0u) << "nothing to compare it with";
}

// A wall turns with the one station that sees it, and a ball moves.
TEST(StationSums, OneStationTurnsAShape)
{
    const Ball ball(0.001, {{0.001, 0.002, -0.001}});
    EXPECT_NEAR(ball.sums().errors_of({0, 0.01}).position, 0.01 * std::hypot(0.05, 0.02), 1e-8) << "by its distance";
    EXPECT_LT(ball.sums().errors_of({0, 0.01}).radius, 1e-8);
    pcm::Shape wall;
    wall.axis = normalised({0.1, 0.9, 0.2});
    wall.point = {454321, 5412345, 310};
    const auto [u, v] = across(wall.axis);
    StationSums sums(wall, wall.point, 4);
    for (int i = -9; i < 10; ++i)
        for (int k = -4; k < 5; ++k) sums.add(wall.point + 0.4 * i * u + 0.1 * k * v, 7);
    const ShapeErrors errors = sums.errors_of({0.003, 0.0002});
    EXPECT_NEAR(errors.angle, 0.0002, 1e-9);
    EXPECT_NEAR(errors.position, 0.003, 1e-8);
}

// Fits of a pipe whose sides three stations see, which are turned: their spread is what the sums claim.
TEST(StationSums, ErrorsOfTurnsAreThoseOfFitsToTurnedPoints)
{
    pcm::Shape pipe;
    pipe.kind = ShapeKind::cylinder;
    pipe.axis = normalised({0.3, 0.2, 0.9});
    pipe.point = {3, -2, 5};
    pipe.radius = 0.4;
    const auto [u, v] = across(pipe.axis);
    Dice dice(11);
    std::vector<Vec3d> points;
    StationSums sums(pipe, pipe.point, 3);
    for (int i = 0; i < 300; ++i) {
        const double a = dice.between(2 * pi * (i % 3) / 3, 2 * pi * (i % 3 + 1) / 3);
        const double along = i % 3 == 0 ? dice.between(-0.2, 0.6) : dice.between(-1, 1);
        points.push_back(pipe.point + along * pipe.axis + pipe.radius * (std::cos(a) * u + std::sin(a) * v));
        sums.add(points.back(), static_cast<std::uint32_t>(i % 3));
    }
    const double turn = 0.001;
    double angles = 0, radii = 0, places = 0;
    constexpr int draws = 400;
    for (int draw = 0; draw < draws; ++draw) {
        std::vector<Vec3d> turns, moved;
        for (int s = 0; s < 3; ++s) turns.push_back(turn * Vec3d{dice.normal(), dice.normal(), dice.normal()});
        for (std::size_t i = 0; i < points.size(); ++i)
            moved.push_back(points[i] + cross(turns[i % 3], points[i] - pipe.point));
        const ShapeFit fit = refine_shape(FitPoints::of(moved), pipe);
        angles += std::pow(length(cross(fit.shape.axis, pipe.axis)), 2);
        radii += std::pow(fit.shape.radius - pipe.radius, 2);
        const Vec3d away = fit.shape.point - pipe.point;
        places += std::pow(length(cross(away, pipe.axis)), 2);
    }
    const ShapeErrors errors = sums.errors_of({0, turn});
    EXPECT_NEAR(std::sqrt(radii / draws), errors.radius, 0.15 * errors.radius);
    // Along the worst direction, and in both.
    for (const auto& [seen, claimed] :
         {std::pair(std::sqrt(angles / draws), errors.angle), std::pair(std::sqrt(places / draws), errors.position)}) {
        EXPECT_GT(seen, 0.9 * claimed);
        EXPECT_LT(seen, 1.5 * claimed);
    }
}

// The restricted likelihood of all distances, from their whole covariance, is greatest where the spread says.
TEST(StationSums, TheSpreadHasTheGreatestRestrictedLikelihood)
{
    const double noise = 0.0015;
    for (const double scale : {1.0, 0.3}) {
        std::vector<Vec3d> shifts = three_shifts;
        for (Vec3d& shift : shifts) shift = scale * shift;
        const Ball ball(noise, shifts);
        const std::size_t n = ball.points.size();
        const auto cost = [&](double spread) {
            Rows v = product(ball.z, turned(ball.z));
            for (std::size_t i = 0; i < n; ++i) {
                for (double& element : v[i]) element *= spread * spread;
                v[i][i] += noise * noise;
            }
            double log_v = 0, log_j = 0;
            const Rows vi = inverse(v, &log_v), jv = product(turned(ball.j), vi),
                       ji = inverse(product(jv, ball.j), &log_j);
            const Rows left = product(turned(ball.distances), product(vi, ball.distances));
            const Rows answer = product(jv, ball.distances);
            return log_v + log_j + left[0][0] - product(turned(answer), product(ji, answer))[0][0];
        };
        const StationSpread found = ball.sums().evidence(noise).spread();
        EXPECT_EQ(found.stations, 3u);
        ASSERT_GT(found.spread, 0);
        for (const double other : {0.8, 0.97, 1.03, 1.25})
            EXPECT_LT(cost(found.spread), cost(other * found.spread)) << scale << ' ' << other << ' ' << found.spread;
    }
}

TEST(StationSums, ShiftsLeaveTheNoiseOfThePoints)
{
    const Ball ball(0.0002, three_shifts, 400);
    const StationSums sums = ball.sums();
    EXPECT_NEAR(sums.noise_within(), 0.0002, 0.00002);
    EXPECT_GT(sums.noise_as_one(), 0.0008);
    const ShiftedFit fit = sums.shifted(0.002, 0.0002);
    double squares = 0, together = 0;
    for (std::size_t i = 0; i < ball.points.size(); ++i) {
        const double distance = sums.distance(fit, ball.points[i], ball.stations[i]);
        squares += distance * distance;
        if (ball.stations[i] == 3) together += distance;
    }
    EXPECT_NEAR(std::sqrt(squares / 1200), 0.0002, 0.00002);
    EXPECT_LT(std::fabs(together / 400), 0.00004);
    const Ball still(0.0002, {{}, {}, {}}, 400);
    EXPECT_LT(still.sums().evidence(0.0002).spread().spread, 0.0001);
}

// From the distances that neither the ball nor, in the second case, shifts of its stations explain.
TEST(StationSums, NoisesAreThoseOfWhatLeastSquaresLeaves)
{
    const Ball ball(0.0015, three_shifts, 6);
    const StationSums sums = ball.sums();
    const std::size_t n = ball.points.size();
    const auto left_by = [&](const Rows& columns) {
        Rows system = product(turned(columns), columns);
        for (std::size_t k = 0; k < system.size(); ++k) system[k][k] += 1e-9;  // shifts of all are moves of the ball
        const Rows answer = product(turned(columns), ball.distances);
        double squares = 0;
        for (const auto& distance : ball.distances) squares += distance[0] * distance[0];
        return squares - product(turned(answer), product(inverse(system), answer))[0][0];
    };
    Rows both = ball.j;
    for (std::size_t i = 0; i < n; ++i) both[i].insert(both[i].end(), ball.z[i].begin(), ball.z[i].end());
    EXPECT_NEAR(sums.noise_as_one(), std::sqrt(left_by(ball.j) / (n - 4.0)), 1e-9);
    EXPECT_NEAR(sums.noise_within(), std::sqrt(left_by(both) / (n - 4.0 - 6)), 1e-9);
    // Sums do not depend on where they are computed from, nor on the unit of length.
    StationSums other(ball.shape, ball.shape.point, 0);
    for (std::size_t i = 0; i < n; ++i) other.add(ball.points[i], ball.stations[i]);
    EXPECT_NEAR(other.noise_as_one(), sums.noise_as_one(), 1e-8);
    EXPECT_NEAR(other.noise_within(), sums.noise_within(), 1e-8);
    EXPECT_NEAR(other.errors_of({1, 0}).radius, sums.errors_of({1, 0}).radius, 1e-5);
}

// The squares of what is left, over the noise, and of the shifts, over the spread, are together the least.
TEST(StationSums, ShiftsAndShapeAreTheMostProbableOnes)
{
    const Ball ball(0.0015, three_shifts, 8);
    const StationSums sums = ball.sums();
    for (const double spread : {0.0, 0.0005, 0.003}) {
        const double noise = 0.001;
        const ShiftedFit fit = sums.shifted(spread, noise);
        ASSERT_EQ(fit.shifts.size(), 3u);
        std::vector<double> by_shape(4, 0.0), by_shift(9, 0.0);
        for (std::size_t i = 0; i < ball.points.size(); ++i) {
            const double left = sums.distance(fit, ball.points[i], ball.stations[i]);
            for (std::size_t k = 0; k < 4; ++k) by_shape[k] += ball.j[i][k] * left;
            for (std::size_t k = 0; k < 9; ++k) by_shift[k] += ball.z[i][k] * left;
        }
        for (const double derivative : by_shape) EXPECT_NEAR(derivative, 0, 1e-8) << spread;
        for (std::size_t k = 0; k < 9; ++k) {
            const double shift = fit.shifts.at(3 + static_cast<std::uint32_t>(k / 3))[k % 3];
            if (spread > 0)
                EXPECT_NEAR(by_shift[k], std::pow(noise / spread, 2) * shift, 1e-8) << spread << " " << k;
            else
                EXPECT_EQ(shift, 0);
        }
    }
    // A station that the fit does not know is not shifted.
    const ShiftedFit fit = sums.shifted(0.003, 0.001);
    const double known = sums.distance(fit, ball.points[0], 3), unknown = sums.distance(fit, ball.points[0], 77);
    EXPECT_NEAR(unknown - known, dot(ball.normals[0], fit.shifts.at(3)), 1e-12);
}

// Stations that see shapes of every kind from all sides: their shifts are found, outwards and inwards.
TEST(StationSums, ShiftsOfStationsAreFoundOnEachKindOfShape)
{
    for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
        pcm::Shape shape;
        shape.kind = kind;
        shape.point = {300, -200, 50};
        shape.axis = normalised({0.3, 0.2, 0.9});
        shape.radius = kind == ShapeKind::plane ? 0 : 0.5;
        if (kind == ShapeKind::cone) shape.radius = 0, shape.second = 0.4;
        const auto [u, v] = across(shape.axis);
        Dice dice(3);
        StationSums sums(shape, shape.point, 2);
        const Vec3d shift{0.002, -0.003, 0.001};
        for (int i = 0; i < 4000; ++i) {
            const Vec3d anywhere =
                shape.point + dice.between(0.2, 1) * shape.axis + dice.between(-1, 1) * u + dice.between(-1, 1) * v;
            const Vec3d n = normal_at(shape, anywhere);
            const Vec3d place = anywhere - signed_distance(shape, anywhere) * n;
            sums.add(place + 1e-5 * dice.normal() * n + (i % 2 ? shift : Vec3d{}), i % 2 ? 9 : 4);
        }
        const StationSpread found = sums.evidence(1e-5).spread();
        EXPECT_GE(found.freedom, 1u);
        EXPECT_LE(found.freedom, kind == ShapeKind::plane ? 1u : kind == ShapeKind::cylinder ? 2u : 3u);
        Vec3d apart = found.shifts.at(9) - found.shifts.at(4), truth = shift;
        if (kind == ShapeKind::plane) truth = dot(truth, shape.axis) * shape.axis;
        if (kind == ShapeKind::cylinder) truth = truth - dot(truth, shape.axis) * shape.axis;
        EXPECT_LT(length(apart - truth), 0.0001) << traits_of(kind).name;
    }
}

TEST(StationSums, WhatPointsDoNotDetermineSaysNothing)
{
    Dice dice(5);
    pcm::Shape ball;
    ball.kind = ShapeKind::sphere;
    ball.radius = 1;
    StationSums few(ball, {}, 1), one_place(ball, {}, 1), enough(ball, {}, 1);
    for (std::uint32_t i = 0; i < 5; ++i) {
        const Vec3d n = dice.direction();
        const double r = 1 + 0.001 * std::pow(i, 2);
        if (i < 4) few.add(r * n, i % 2);
        one_place.add({r, 0, 0}, i % 2);
        enough.add(r * n, i % 2);
    }
    EXPECT_TRUE(enough.is_determined());
    for (const StationSums* none : {&few, &one_place}) EXPECT_FALSE(none->is_determined());
    EXPECT_EQ(few.noise_as_one(), 0) << "nothing is left to vary";
    EXPECT_EQ(few.noise_within(), 0);
    EXPECT_GT(enough.noise_as_one(), 0);
    EXPECT_EQ(one_place.noise_as_one(), 0);
    EXPECT_EQ(one_place.noise_within(), 0);
    EXPECT_EQ(one_place.evidence(1).stations(), 0u);
    EXPECT_EQ(one_place.errors_of({1, 0}).position, 0);
    EXPECT_TRUE(one_place.shifted(1, 1).shifts.empty());
    EXPECT_EQ(enough.evidence(0).stations(), 0u);
    EXPECT_EQ(enough.evidence(1).stations(), 2u);
}

TEST(StationSums, StationsAreComparedUpToTheirMaximumNumber)
{
    Dice dice(6);
    pcm::Shape ball;
    ball.kind = ShapeKind::sphere;
    ball.radius = 1;
    StationSums sums(ball, {}, 1);
    for (std::uint32_t station = 0; station <= StationEvidence::most_stations; ++station) {
        EXPECT_EQ(sums.evidence(0.1).stations(), station < 2 ? 0 : station);
        for (int i = 0; i < 5; ++i) sums.add(1.001 * dice.direction(), station);
    }
    EXPECT_EQ(sums.evidence(0.1).stations(), 0u);
}

// Cylinders whose stations are shifted, fitted: their radii and axes scatter as the errors say.
// Under the address sanitizer left out: a thousand fits, of code that other tests run too.
TEST(StationSums, PCM_NOT_UNDER_ADDRESS(FitsOfShiftedStationsScatterAsTheErrorsSay))
{
    pcm::Shape pipe;
    pipe.kind = ShapeKind::cylinder;
    pipe.axis = normalised({0.3, 0.2, 0.9});
    pipe.point = {300, -200, 50};
    pipe.radius = 0.15;
    const auto [u, v] = across(pipe.axis);
    Dice dice(3);
    std::vector<Vec3d> places;
    std::vector<std::uint32_t> stations;
    for (int i = 0; i < 600; ++i) {
        const auto station = static_cast<std::uint32_t>(i % 2);
        const double a = dice.between(0, 2.2) + 2.0 * station;
        places.push_back(pipe.point + dice.between(-0.5, 0.5) * pipe.axis +
                         pipe.radius * (std::cos(a) * u + std::sin(a) * v));
        stations.push_back(station);
    }
    StationSums sums(pipe, pipe.point, 1);
    for (std::size_t i = 0; i < places.size(); ++i) sums.add(places[i], stations[i]);
    const double spread = 0.0005;
    const ShapeErrors errors = sums.errors_of({spread, 0});
    double radii = 0, angles = 0, across_u = 0, across_v = 0, mixed = 0;
    constexpr int draws = 1000;
    for (int draw = 0; draw < draws; ++draw) {
        std::vector<Vec3d> shifts;
        for (int s = 0; s < 2; ++s)
            shifts.push_back({spread * dice.normal(), spread * dice.normal(), spread * dice.normal()});
        FitPoints points;
        points.origin = pipe.point;
        for (std::size_t i = 0; i < places.size(); ++i) points.add(places[i] + shifts[stations[i]]);
        const pcm::Shape found = refine_shape(points, pipe).shape;
        radii += std::pow(found.radius - pipe.radius, 2) / draws;
        angles += std::pow(length(cross(found.axis, pipe.axis)), 2) / draws;
        const Vec3d moved = traits_of(pipe.kind).place_near(found, pipe.point) - pipe.point;
        across_u += std::pow(dot(moved, u), 2) / draws;
        across_v += std::pow(dot(moved, v), 2) / draws;
        mixed += dot(moved, u) * dot(moved, v) / draws;
    }
    const double largest = (across_u + across_v) / 2 + std::hypot((across_u - across_v) / 2, mixed);
    // A thousand draws know a standard deviation to 2 %.
    EXPECT_NEAR(std::sqrt(radii), errors.radius, 0.08 * errors.radius);
    EXPECT_NEAR(std::sqrt(largest), errors.position, 0.08 * errors.position);
    // The angle's error is that about the least certain direction.
    EXPECT_GT(std::sqrt(angles), 0.9 * errors.angle);
    EXPECT_LT(std::sqrt(angles), 1.5 * errors.angle);
}

TEST(StationSpread, FewDifferencesWidenAsStudentDoes)
{
    EXPECT_EQ(student_factor(0), 1);
    // Quantiles of Student's t at 0.84134.
    const double expected[] = {1.8373, 1.3213, 1.1969, 1.1416, 1.1105};
    for (std::uint32_t n = 1; n <= 5; ++n) EXPECT_NEAR(student_factor(n), expected[n - 1], 0.002) << n;
    EXPECT_NEAR(student_factor(100), 1.005, 0.0005);
}

}  // namespace
