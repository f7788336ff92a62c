// What stations add to the errors of fits that are made up: on points of the shape, or on any.
#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/fit/station_sums.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/point_stations.h"
#include "pcm/place/refit.h"
#include "pcm/place/station_errors.h"
#include "pcm/place/station_survey.h"
#include "tests/place/station_cloud.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;

class AddedErrors : public testing::Test {
protected:
    std::shared_ptr<const Tree> tree(const std::vector<StationPoint>& points, Says says)
    {
        write_stations_ply(folder_ / "some.ply", points, says);
        BuildOptions options;
        options.overwrite = true;
        build_tree({folder_ / "some.ply"}, folder_ / "some.pct", options);
        return Tree::open(folder_ / "some.pct");
    }
    // A ball of equally many points of each station, which all see all of it; `off` moves a point outwards.
    std::vector<StationPoint> ball(int points, int stations, const std::vector<Vec3d>& shifts,
                                   const std::function<double(const Vec3d& n)>& off = {})
    {
        std::vector<StationPoint> all;
        for (int i = 0; i < points; ++i) {
            const Vec3d n = dice_.direction();
            const double r = ball_.radius + (off ? off(n) : 0) + scan_noise * dice_.normal();
            const Vec3d shift = shifts.empty() ? Vec3d{} : shifts[static_cast<std::size_t>(i % stations)];
            all.push_back({ball_.point + r * n + shift, i % stations});
        }
        return all;
    }
    static Primitive fitted(const pcm::Shape& shape, const ShapeErrors& errors)
    {
        Primitive primitive;
        primitive.fit.verdict = FitVerdict::good;
        primitive.fit.shape = shape;
        primitive.fit.errors = errors;
        return primitive;
    }
    static double add(const std::shared_ptr<const Tree>& tree, Primitive& primitive, double registration,
                      double agreement = 1)
    {
        StationErrorOptions options;
        options.registration = registration;
        StationsAround around(*tree, primitive.fit.shape.point);
        add_station_errors(PointSet::all_of(tree), around, options, agreement, primitive);
        return agreement;
    }
    Dice dice_{31};
    TemporaryFolder folder_;
    pcm::Shape ball_{ShapeKind::sphere, hall, {0, 0, 1}, 1, 0};
};

// Sizes that are angles are as uncertain as the place at a distance, and lengths are as uncertain as the place.
TEST_F(AddedErrors, OfUnknownStationsAreThoseOfEachKindsNumbers)
{
    const auto any = tree(ball(500, 1, {}), Says::nothing);
    const ShapeErrors before{0.001, 0.002, 0.003, 0.0004};
    for (const ShapeKind kind :
         {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone, ShapeKind::torus}) {
        SCOPED_TRACE(traits_of(kind).name);
        const bool has_radius = kind != ShapeKind::plane && kind != ShapeKind::cone;
        const double second = kind == ShapeKind::cone    ? std::hypot(0.0004, 20 * 0.0004)
                              : kind == ShapeKind::torus ? std::hypot(0.0004, 0.02)
                                                         : 0.0004;
        Primitive primitive = fitted({kind, hall, {0, 0, 1}, 3, 0.5}, before);
        EXPECT_EQ(add(any, primitive, 0.02, 2), 2);
        const ShapeErrors& after = primitive.fit.errors;
        EXPECT_NEAR(after.position, std::hypot(0.001, 0.02), 1e-15);
        // A station that sees the whole ball, whose radius is 1: half the diagonal of a box as large, sqrt(3).
        const double turn = kind == ShapeKind::sphere ? 0 : 0.02 / std::sqrt(3);
        EXPECT_NEAR(after.angle, std::hypot(0.002, 0.04, turn), 1e-3 * after.angle);
        EXPECT_NEAR(primitive.stations->turn, 0.02 / std::sqrt(3), 1e-4);
        EXPECT_NEAR(after.radius, has_radius ? std::hypot(0.003, 0.02) : 0.003, 1e-15);
        EXPECT_NEAR(after.second, second, 1e-15);
        ASSERT_TRUE(primitive.stations);
        EXPECT_EQ(primitive.stations->source, StationSource::none);
        EXPECT_EQ(primitive.stations->stations, 0u);
        EXPECT_EQ(primitive.stations->registration, 0.02);
    }
    Primitive exact = fitted(ball_, {0, 0.002, 0, 0});
    add(any, exact, 0.02);
    EXPECT_EQ(exact.fit.errors.position, 0.02);
    EXPECT_EQ(exact.fit.errors.angle, 0.002) << "a place without an error has no lever";
    Primitive cone = fitted({ShapeKind::cone, hall, {0, 0, 1}, 0, 0.5}, {0, 0, 0, 0.0004});
    add(any, cone, 0.02);
    EXPECT_EQ(cone.fit.errors.second, 0.0004);
    Primitive tiny = fitted(ball_, {1e-320, 0, 0, 0});
    add(any, tiny, 0.02);
    EXPECT_EQ(tiny.fit.errors.angle, 0);
    Primitive turning = fitted(ball_, {0.001, infinity, 0, 0});
    add(any, turning, 0.02);
    EXPECT_EQ(turning.fit.errors.angle, infinity);
}

TEST_F(AddedErrors, AreThoseOfShapesAndSetsWithPoints)
{
    const auto any = tree(ball(500, 1, {}), Says::nothing);
    Primitive refused = fitted(ball_, {0.001, 0, 0, 0});
    refused.fit.verdict = FitVerdict::refused;
    add(any, refused, 0.02);
    EXPECT_FALSE(refused.stations);
    EXPECT_EQ(refused.fit.errors.position, 0.001);
    Primitive empty = fitted(ball_, {0.001, 0, 0, 0});
    double agreement = 1;
    StationsAround around(*any, hall);
    add_station_errors(PointSet(any), around, {0.02}, agreement, empty);
    EXPECT_FALSE(empty.stations);
    EXPECT_EQ(empty.fit.errors.position, 0.001);
}

// A good fit is doubted where, with the stations, less than ten of its errors are in its least certain size.
TEST_F(AddedErrors, DoubtGoodFitsOfWhichTheSizeIsUncertain)
{
    const auto any = tree(ball(500, 1, {}), Says::nothing);
    const double limit = fit_tuning().judgement.good_significance;
    const auto after = [&](const pcm::Shape& shape, double registration) {
        Primitive primitive = fitted(shape, {registration, 0, 0, shape.kind == ShapeKind::cone ? 0.01 : 0});
        add(any, primitive, registration);
        return primitive.fit;
    };
    const auto verdict = [&](const pcm::Shape& shape, double registration) {
        return after(shape, registration).verdict;
    };
    const pcm::Shape ball{ShapeKind::sphere, hall, {0, 0, 1}, limit / 8, 0};
    EXPECT_EQ(verdict(ball, 0.125), FitVerdict::good) << "just as many";
    EXPECT_EQ(verdict(ball, 0.1251), FitVerdict::doubtful);
    const ShapeFit doubted = after(ball, 0.1251);
    EXPECT_EQ(doubted.issue, FitIssue::thin_arc);
    EXPECT_NE(doubted.message.find("take points farther around it"), std::string::npos) << doubted.message;
    EXPECT_EQ(after(ball, 0.125).issue, FitIssue::none);
    EXPECT_EQ(after(ball, 0.125).message, "");
    EXPECT_EQ(verdict({ShapeKind::plane, hall, {0, 0, 1}, 0, 0}, 100), FitVerdict::good) << "it has no size";
    // Rings are doubted for either of their sizes, cones for their angle from the axis and from a plane.
    EXPECT_EQ(verdict({ShapeKind::torus, hall, {0, 0, 1}, limit, limit / 2}, 0.25), FitVerdict::good);
    EXPECT_EQ(verdict({ShapeKind::torus, hall, {0, 0, 1}, limit, limit / 10}, 0.25), FitVerdict::doubtful);
    EXPECT_EQ(verdict({ShapeKind::torus, hall, {0, 0, 1}, limit / 10, limit}, 0.25), FitVerdict::doubtful);
    EXPECT_EQ(verdict({ShapeKind::cone, hall, {0, 0, 1}, 0, 0.5}, 1), FitVerdict::good);
    EXPECT_EQ(verdict({ShapeKind::cone, hall, {0, 0, 1}, 0, 0.01}, 1), FitVerdict::doubtful);
    EXPECT_EQ(verdict({ShapeKind::cone, hall, {0, 0, 1}, 0, pi / 2 - 0.01}, 1), FitVerdict::doubtful);

    Primitive other = fitted(ball, {0.001, 0, 0.001, 0});
    other.fit.verdict = FitVerdict::doubtful;
    other.fit.issue = FitIssue::uneven;
    other.fit.message = "uneven";
    add(any, other, 1);
    EXPECT_EQ(other.fit.issue, FitIssue::uneven) << "what was doubted before stays so";
    EXPECT_EQ(other.fit.message, "uneven");
}

// The same from the stations of the points, which this shape has.
TEST_F(AddedErrors, DoubtGoodFitsWhoseStationsAreFarApart)
{
    // Half of the ball, which two stations see, each one side more than the other.
    std::vector<StationPoint> half = ball(9000, 2, {});
    for (StationPoint& p : half) p.station = dice_.unit() < (p.position[1] > hall[1] ? 0.8 : 0.2);
    half.erase(std::remove_if(half.begin(), half.end(), [](const StationPoint& p) { return p.position[0] < hall[0]; }),
               half.end());
    const auto cap = tree(half, Says::source_id);
    Primitive near = fitted(ball_, {1e-4, 0, 1e-4, 0}), apart = near;
    add(cap, near, 0.001);
    add(cap, apart, 1);
    EXPECT_EQ(near.stations->stations, 2u);
    EXPECT_EQ(near.fit.verdict, FitVerdict::good);
    EXPECT_EQ(apart.fit.verdict, FitVerdict::doubtful);
}

// What is given is added by the stations that there are, unless there are more than are distinguished.
TEST_F(AddedErrors, ManyStationsAreAsUnknownOnes)
{
    for (const int count : {48, 49}) {
        const auto seen = tree(ball(100 * count, count, {}), Says::source_id);
        for (const double registration : {0.0, 0.01}) {
            Primitive primitive = fitted(ball_, {1e-4, 0, 1e-4, 0});
            EXPECT_EQ(add(seen, primitive, registration), 1);
            ASSERT_TRUE(primitive.stations);
            EXPECT_EQ(primitive.stations->stations, static_cast<unsigned>(count));
            EXPECT_EQ(primitive.stations->freedom > 0, count == 48);
            const ShapeErrors& errors = primitive.fit.errors;
            if (count == 48) {
                EXPECT_GE(errors.position, registration / 10);
                EXPECT_LT(errors.radius, 0.0005) << "each sees all of the ball";
            } else {
                EXPECT_DOUBLE_EQ(errors.position, std::hypot(1e-4, registration));
                EXPECT_DOUBLE_EQ(errors.radius, std::hypot(1e-4, registration));
            }
        }
        Primitive doubted = fitted(ball_, {1e-4, 0, 1e-4, 0});
        add(seen, doubted, 0.2);
        EXPECT_EQ(doubted.fit.verdict, count == 48 ? FitVerdict::good : FitVerdict::doubtful);
    }
}

// Two points of a ball say nothing of it.
TEST_F(AddedErrors, PointsThatDoNotDetermineTheShapeAddNothing)
{
    const auto seen = tree(ball(4000, 2, {{0.01, 0, 0}, {}}), Says::source_id);
    PointSet two(seen);
    two.set(0, {0, 1});
    Primitive primitive = fitted(ball_, {1e-4, 0, 1e-4, 0});
    double agreement = 2;
    StationsAround around(*seen, hall);
    add_station_errors(two, around, {0.02}, agreement, primitive);
    EXPECT_EQ(agreement, 2);
    EXPECT_EQ(primitive.fit.errors.position, 1e-4);
    EXPECT_EQ(primitive.fit.verdict, FitVerdict::good);
}

// Errors that neighbours share because their stations are shifted are independent within the stations; those that they
// share because the surface is not a ball remain.
TEST_F(AddedErrors, TheAgreementIsThatWithinStations)
{
    const ShapeErrors before{1e-3, 2e-3, 3e-3, 0};
    const std::vector<Vec3d> shifts{{0.006, 0, 0.002}, {-0.004, 0.005, 0}, {0, -0.006, -0.005}};
    const auto bumps = [](const Vec3d& n) { return 0.01 * std::sin(9 * n[0]) * std::sin(9 * n[1]); };
    for (const bool even : {true, false}) {
        const auto points = ball(9000, even ? 3 : 2, shifts, even ? std::function<double(const Vec3d&)>() : bumps);
        const auto seen = tree(points, Says::source_id);
        Box3d box;
        for (const PlacedPoint& p : all_points(*seen)) box.extend(p.position);
        StationSums sums(ball_, box.centre(), box.diagonal());
        for (const StationPoint& p : points) sums.add(p.position, static_cast<std::uint32_t>(11 + p.station));
        const double within = sums.noise_within(), share = std::min(1.0, within / sums.noise_as_one());
        for (const double given : {1.0, 1.5, 40.0}) {
            Primitive primitive = fitted(ball_, before);
            const double agreement = add(seen, primitive, 0, given);
            EXPECT_GE(agreement, 1);
            if (given == 1.0)
                EXPECT_EQ(agreement, 1);
            else if (even)
                EXPECT_LT(agreement, 1.2);
            else if (given == 1.5)
                EXPECT_EQ(agreement, 1.5) << "no more than before";
            else
                EXPECT_NEAR(agreement, 10, 7);
            const StationSurvey survey = station_survey(*seen, PointStations(*seen), primitive.fit.shape.point);
            const StationSpread spread = survey.evidence(sums.evidence(within * agreement)).spread();
            EXPECT_NEAR(primitive.stations->spread, spread.spread, 1e-3 * spread.spread);
            EXPECT_EQ(primitive.stations->freedom, spread.freedom);
            const auto added = [&](double registration) {
                const double shift = std::max(spread.spread * student_factor(spread.freedom), registration);
                return sums.errors_of({shift, shift / survey.reach});
            };
            const double smaller = share * agreement / given;
            const ShapeErrors& after = primitive.fit.errors;
            EXPECT_NEAR(after.position, std::hypot(smaller * before.position, added(0).position),
                        1e-3 * after.position);
            EXPECT_NEAR(after.radius, std::hypot(smaller * before.radius, added(0).radius), 1e-3 * after.radius);
            // What is given counts where it is larger.
            Primitive known = fitted(ball_, before);
            add(seen, known, 0.1, given);
            EXPECT_NEAR(known.fit.errors.position, std::hypot(smaller * before.position, added(0.1).position),
                        1e-3 * known.fit.errors.position);
        }
    }
}

// A ball that one station sees, off its place and with bumps, and a second one of another station far from it.
TEST_F(AddedErrors, OneStationOfSeveralChangesNothingByItself)
{
    std::vector<StationPoint> points =
        ball(4000, 1, {{0.01, 0, 0}}, [](const Vec3d& n) { return 0.01 * std::sin(9 * n[0]); });
    for (std::size_t i = 0; i < 4000; ++i) points.push_back({points[i].position + Vec3d{10, 0, 0}, 1});
    const auto seen = tree(points, Says::source_id);
    const PointSet first = set_where(seen, [](const Vec3d& p) { return p[0] < hall[0] + 5; });
    ASSERT_EQ(first.size(), 4000u);
    Primitive primitive = fitted(ball_, {1e-3, 2e-3, 0.2, 0});
    double agreement = 40;
    StationsAround around(*seen, hall);
    add_station_errors(first, around, {0}, agreement, primitive);
    EXPECT_EQ(primitive.stations->source, StationSource::attribute);
    EXPECT_EQ(primitive.stations->stations, 1u);
    EXPECT_EQ(primitive.stations->freedom, 0u);
    EXPECT_EQ(agreement, 40);
    EXPECT_EQ(primitive.fit.errors.position, 1e-3);
    EXPECT_EQ(primitive.fit.errors.radius, 0.2);
    EXPECT_EQ(primitive.fit.verdict, FitVerdict::good) << "no station makes its size uncertain";
}

// The doubt is that of stations, not one of all fits.
TEST_F(AddedErrors, WhereNothingIsAddedNothingIsDoubted)
{
    for (const int stations : {1, 49}) {
        const auto seen =
            tree(ball(100 * std::max(5, stations), stations, {}), stations > 1 ? Says::source_id : Says::nothing);
        double without = 0;
        for (const double registration : {0.0, 1e-6}) {
            Primitive primitive = fitted(ball_, {1e-3, 2e-3, 0.2, 0});
            add(seen, primitive, registration);
            if (registration > 0)
                EXPECT_GT(primitive.fit.errors.radius, without);
            else
                without = primitive.fit.errors.radius;
            EXPECT_NEAR(primitive.fit.errors.radius, 0.2, 1e-5) << "but for points that are turned from their stations";
            // Points of stations that cannot be distinguished are looked at, whatever is given.
            if (stations == 1)
                EXPECT_EQ(primitive.fit.verdict, registration > 0 ? FitVerdict::doubtful : FitVerdict::good);
        }
    }
}

// A thin pipe that two stations see from one side; one of them has points next to both silhouettes, behind them.
TEST_F(AddedErrors, PointsThatAreTurnedFromTheirStationAreLeftOut)
{
    pcm::Shape pipe{ShapeKind::cylinder, hall, {0, 0, 1}, 0.03, 0};
    std::vector<StationPoint> own, all;
    const auto at = [&](double angle, double r) {
        return hall + Vec3d{r * std::cos(angle), r * std::sin(angle), dice_.between(-1, 1)};
    };
    for (int i = 0; i < 4000; ++i)
        own.push_back({at(std::asin(0.93 * dice_.between(-1, 1)), 0.03 + scan_noise * dice_.normal()), i % 2});
    all = own;
    for (int i = 0; i < 300; ++i) all.push_back({at((i % 2 ? 1 : -1) * dice_.between(1.7, 2.5), 0.033), 0});
    const auto fit = [&](const std::vector<StationPoint>& points) {
        std::vector<Vec3d> places;
        for (const StationPoint& p : points) places.push_back(p.position);
        RefineOptions refine;
        refine.threshold = 4 * scan_noise;
        Primitive primitive;
        primitive.fit = refine_shape(FitPoints::of(places), pipe, refine);
        primitive.fit.threshold = 0;
        for (const Vec3d& p : places)
            primitive.fit.threshold = std::max(primitive.fit.threshold, distance_to(primitive.fit.shape, p));
        add(tree(points, Says::source_id), primitive, 0);
        for (const Vec3d& p : places) EXPECT_LE(distance_to(primitive.fit.shape, p), primitive.fit.threshold);
        return primitive;
    };
    const Primitive without = fit(own), with = fit(all);
    const auto off = [&](const Primitive& one) { return difference_of(pipe, one.fit.shape, hall); };
    EXPECT_LT(off(with).position, 3 * with.fit.errors.position);
    EXPECT_LT(off(with).radius, 3 * with.fit.errors.radius);
    EXPECT_LT(off(with).position, 0.0004);
    EXPECT_GT(with.fit.errors.position, 0.9 * without.fit.errors.position);
    EXPECT_EQ(with.stations->stations, 2u);
}

// Such points behind one silhouette, where the other station sees the pipe, do not show that stations are apart.
TEST_F(AddedErrors, PointsThatAreTurnedFromTheirStationDoNotPartTheStations)
{
    const pcm::Shape pipe{ShapeKind::cylinder, hall, {0, 0, 1}, 0.03, 0};
    std::vector<StationPoint> points;
    const auto put = [&](double angle, double r, int station) {
        points.push_back({hall + Vec3d{r * std::cos(angle), r * std::sin(angle), dice_.between(-1, 1)}, station});
    };
    for (int i = 0; i < 4000; ++i)
        put(std::asin(0.93 * dice_.between(-1, 1)) + (i % 2) * pi / 2, 0.03 + scan_noise * dice_.normal(), i % 2);
    const auto spread = [&] {
        Primitive primitive = fitted(pipe, {1e-4, 1e-4, 1e-4, 0});
        primitive.fit.threshold = 4 * scan_noise;
        add(tree(points, Says::source_id), primitive, 0);
        return primitive.stations->spread;
    };
    const double without = spread();
    for (int i = 0; i < 300; ++i) put(dice_.between(1.8, 2.4), 0.035, 0);
    EXPECT_LT(spread(), without + 0.0001);
}

TEST_F(AddedErrors, ProgressIsThatOfFourPasses)
{
    const auto seen = tree(ball(9000, 2, {{0.01, 0, 0}, {}}), Says::source_id);
    std::vector<double> fractions;
    const auto run = [&](bool goes_on) {
        fractions.clear();
        StationErrorOptions options;
        StationsAround around(*seen, hall);
        options.threads = 1;
        options.progress = [&](const ProgressUpdate& progress) {
            EXPECT_EQ(progress.stage, "Comparing stations");
            fractions.push_back(progress.fraction);
            return goes_on;
        };
        double agreement = 2;
        Primitive primitive = fitted(ball_, {1e-4, 0, 1e-4, 0});
        add_station_errors(PointSet::all_of(seen), around, options, agreement, primitive);
    };
    run(true);
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    for (const double begin : {0.0, 0.25, 0.5, 0.75})
        EXPECT_TRUE(std::any_of(fractions.begin(), fractions.end(), [=](double f) {
            return std::fabs(f - begin) < 1e-9;
        })) << begin;
    EXPECT_LE(fractions.back(), 1);
    EXPECT_THROW(run(false), Error);
}

}  // namespace
