// What the errors of a fit contain of how far stations are apart: clouds of several stations with known shifts.
#include "pcm/place/fit_at.h"
#include "pcm/place/point_stations.h"
#include "pcm/place/station_survey.h"
#include "tests/place/station_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace {

using namespace pcm;
using namespace pcm::test;

// A pipe, a ball and walls, each point seen by one of the stations that see its side.
class StationErrors : public testing::Test {
protected:
    void SetUp() override
    {
        pipe_.kind = ShapeKind::cylinder;
        pipe_.point = hall + Vec3d{2, 0, 1};
        pipe_.radius = 0.2;
        ball_.kind = ShapeKind::sphere;
        ball_.point = hall + Vec3d{-2, 0, 1};
        ball_.radius = 0.25;
    }
    std::shared_ptr<PointCloud> cloud(double spread, std::uint64_t seed, Says says, bool walls = true,
                                      double pipe_noise = scan_noise)
    {
        Dice dice(seed);
        std::vector<Vec3d> shifts;
        for (int s = 0; s < 3; ++s)
            shifts.push_back({spread * dice.normal(), spread * dice.normal(), spread * dice.normal()});
        std::vector<StationPoint> points;
        const auto put = [&](const Vec3d& p, const Vec3d& n, int station) {
            points.push_back({p + scan_noise * dice.normal() * n + shifts[static_cast<std::size_t>(station)], station});
        };
        for (int i = 0; i < 9000; ++i) {
            const double a = dice.between(0, 2 * pi);
            const Vec3d n{std::cos(a), std::sin(a), 0};
            const double rough = pipe_noise * pipe_noise - scan_noise * scan_noise;
            const double off = rough > 0 ? std::sqrt(rough) * dice.normal() : 0;
            put(pipe_.point + Vec3d{0, 0, dice.between(-0.6, 0.6)} + (pipe_.radius + off) * n, n,
                std::min(2, static_cast<int>(a / (2 * pi) * 3)));
        }
        // One station sees the ball.
        for (int i = 0; i < 5000; ++i) {
            const Vec3d n = dice.direction();
            if (n[0] > -0.3) put(ball_.point + ball_.radius * n, n, 1);
        }
        for (int i = 0; walls && i < 40000; ++i) {
            const double a = dice.between(-4, 4), b = dice.between(-4, 4);
            const int station = i % 3;
            if (i % 9 < 3)
                put(hall + Vec3d{a, b, 0}, {0, 0, 1}, station);
            else if (i % 9 < 6)
                put(hall + Vec3d{a, 4, 1 + b / 4}, {0, -1, 0}, station);
            else
                put(hall + Vec3d{4, a, 1 + b / 4}, {-1, 0, 0}, station);
        }
        // A board as rough as the pipe.
        for (int i = 0; pipe_noise > scan_noise && i < 9000; ++i) {
            const double off = std::sqrt(pipe_noise * pipe_noise - scan_noise * scan_noise) * dice.normal();
            put(board_ + Vec3d{dice.between(-0.6, 0.6), dice.between(-0.6, 0.6), off}, {0, 0, 1}, i % 3);
        }
        build_station_tree(folder_.path(), points, says);
        return PointCloud::open(folder_ / "stations.pct");
    }
    FittedPrimitive fit(const PointCloud& cloud, const pcm::Shape& shape, double registration = 0) const
    {
        FitAtOptions options;
        options.fit.kind = shape.kind;
        options.registration = registration;
        return fit_at(cloud, {shape.point + Vec3d{-shape.radius, 0, 0}}, {}, options);
    }
    pcm::Shape pipe_, ball_;
    Vec3d board_ = hall + Vec3d{-1, -2.5, 2};
    TemporaryFolder folder_;
};

// What shifts of the stations would explain, the noise of each of them by itself does not.
TEST_F(StationErrors, PCM_NOT_UNDER_SANITIZERS(PointsOfOneStationThatLeaveAPipeAreDoubted))
{
    const auto judged = [&](double noise, double threshold) {
        FitAtOptions options;
        options.fit.kind = pipe_.kind;
        options.fit.threshold = threshold;
        const auto there = cloud(0.003, 31, Says::source_id, true, noise);
        return fit_at(*there, {pipe_.point + Vec3d{-pipe_.radius, 0, 0}}, {}, options).primitive.fit;
    };
    const ShapeFit smooth = judged(1.8 * scan_noise, 0), rough = judged(2.8 * scan_noise, 0);
    EXPECT_EQ(smooth.verdict, FitVerdict::good) << smooth.message;
    EXPECT_EQ(rough.verdict, FitVerdict::doubtful);
    EXPECT_NE(rough.message.find("points of one station leave it by 0.004"), std::string::npos) << rough.message;
    EXPECT_EQ(judged(2.8 * scan_noise, 0.015).verdict, FitVerdict::good) << "a given threshold says what lies on it";
    // Walls may be rough.
    FitAtOptions options;
    options.fit.kind = ShapeKind::plane;
    const auto there = cloud(0.003, 31, Says::source_id, true, 2.8 * scan_noise);
    const FittedPrimitive board = fit_at(*there, {board_}, {}, options);
    EXPECT_EQ(board.primitive.fit.verdict, FitVerdict::good) << board.primitive.fit.message;
    EXPECT_GT(board.primitive.fit.noise, 2.5 * scan_noise);
}

// Minutes there; the code is that of the next tests.
TEST_F(StationErrors, PCM_NOT_UNDER_SANITIZERS(RadiiAndPositionsLieWithinThreeDeviations))
{
    int good = 0, radii = 0, positions = 0, without = 0;
    double contained = 0, quotient = 0;
    constexpr int scenes = 6;
    for (int scene = 0; scene < scenes; ++scene) {
        const auto there = cloud(0.0015, 20 + static_cast<std::uint64_t>(scene), Says::source_id);
        for (const pcm::Shape& truth : {pipe_, ball_}) {
            const FittedPrimitive found = fit(*there, truth);
            const ShapeFit& fit = found.primitive.fit;
            ASSERT_TRUE(fit.has_shape()) << fit.message;
            good += fit.verdict == FitVerdict::good;
            ASSERT_TRUE(found.primitive.stations);
            EXPECT_EQ(found.primitive.stations->stations, truth.kind == ShapeKind::sphere ? 1u : 3u);
            EXPECT_GE(found.primitive.stations->freedom, 4u);
            contained += std::log(found.primitive.stations->spread / 0.0015) / (2 * scenes);
            const double off = std::fabs(fit.shape.radius - truth.radius);
            const double moved = length(traits_of(truth.kind).place_near(fit.shape, truth.point) - truth.point);
            radii += off > 3 * fit.errors.radius;
            positions += moved > 3 * fit.errors.position;
            quotient += std::pow(moved / fit.errors.position, 2) / (2 * scenes);
            // What independent points of this noise would claim.
            without += moved > 3 * 2 * scan_noise / std::sqrt(static_cast<double>(fit.inliers));
        }
    }
    EXPECT_GE(good, 2 * scenes - 2);
    EXPECT_EQ(radii, 0);
    EXPECT_LE(positions, 2) << "three stations show a spread to a third";
    EXPECT_GE(without, scenes) << "without the stations most positions are not";
    EXPECT_LT(std::fabs(contained), 0.35) << "the spread is found";
    EXPECT_GT(quotient, 0.4);
    EXPECT_LT(quotient, 6) << "positions lie in three directions";
}

TEST_F(StationErrors, PCM_NOT_UNDER_THREAD(StationsThatAreNotShiftedAddNextToNothing))
{
    const auto there = cloud(0, 3, Says::source_id);
    for (const pcm::Shape& truth : {pipe_, ball_}) {
        const FittedPrimitive found = fit(*there, truth);
        ASSERT_TRUE(found.primitive.stations);
        EXPECT_LT(found.primitive.stations->spread, 0.0003);
        EXPECT_LT(found.primitive.fit.errors.radius, 0.00025);
        EXPECT_LT(std::fabs(found.primitive.fit.shape.radius - truth.radius), 3 * found.primitive.fit.errors.radius);
    }
}

TEST_F(StationErrors, PCM_NOT_UNDER_THREAD(GapsInTimeAreStations))
{
    const auto by_time = cloud(0.0015, 5, Says::time);
    EXPECT_EQ(PointStations(*by_time->tree()).source(), StationSource::time_gaps);
    const FittedPrimitive gaps = fit(*by_time, pipe_);
    const auto by_id = cloud(0.0015, 5, Says::source_id);
    EXPECT_EQ(PointStations(*by_id->tree()).attribute(), "point_source_id");
    const FittedPrimitive ids = fit(*by_id, pipe_);
    EXPECT_EQ(gaps.primitive.stations->stations, 3u);
    EXPECT_EQ(gaps.primitive.stations->spread, ids.primitive.stations->spread);
    EXPECT_EQ(gaps.primitive.fit.errors.radius, ids.primitive.fit.errors.radius);
    EXPECT_EQ(gaps.primitive.fit.errors.position, ids.primitive.fit.errors.position);
}

// The points of tiles mix nowhere.
TEST_F(StationErrors, PCM_NOT_UNDER_THREAD(NumbersOfTilesAreNoStations))
{
    const auto tiles = cloud(0, 8, Says::tiles), nothing = cloud(0, 8, Says::nothing);
    EXPECT_EQ(PointStations(*tiles->tree()).source(), StationSource::attribute);
    EXPECT_FALSE(station_survey(*tiles->tree(), PointStations(*tiles->tree()), pipe_.point).names_stations);
    const FittedPrimitive by_tile = fit(*tiles, pipe_), without = fit(*nothing, pipe_);
    ASSERT_TRUE(by_tile.primitive.stations);
    EXPECT_EQ(by_tile.primitive.stations->source, StationSource::none);
    EXPECT_EQ(by_tile.primitive.fit.errors.position, without.primitive.fit.errors.position);
    EXPECT_EQ(by_tile.primitive.fit.errors.radius, without.primitive.fit.errors.radius);
}

// As above.
TEST_F(StationErrors, PCM_NOT_UNDER_SANITIZERS(WhereNothingSaysTheStationWhatIsGivenIsAddedInQuadrature))
{
    for (const Says says : {Says::nothing, Says::one_source_id, Says::other_ids}) {
        const auto there = cloud(0.001, 6, says);
        const FittedPrimitive points = fit(*there, pipe_), given = fit(*there, pipe_, 1.5);
        ASSERT_TRUE(points.primitive.stations);
        EXPECT_EQ(points.primitive.stations->source, StationSource::none);
        EXPECT_EQ(points.primitive.stations->contained(), 0);
        EXPECT_EQ(given.primitive.stations->registration, 0.0015);
        const ShapeErrors &a = points.primitive.fit.errors, &b = given.primitive.fit.errors;
        EXPECT_NEAR(b.position, std::hypot(a.position, 0.0015), 1e-12);
        EXPECT_NEAR(b.radius, std::hypot(a.radius, 0.0015), 1e-12);
        EXPECT_NEAR(b.angle, std::hypot(a.angle, 0.0015 * a.angle / a.position, given.primitive.stations->turn), 1e-12);
        EXPECT_NEAR(given.primitive.stations->turn,
                    0.0015 / station_survey(*there->tree(), PointStations(*there->tree()), pipe_.point).reach, 1e-9);
    }
}

// A scan that is repeated twenty times says no more than once. Not under sanitizers: as above.
TEST_F(StationErrors, PCM_NOT_UNDER_SANITIZERS(PointsThatAreRepeatedCountAsPlaces))
{
    Dice dice(12);
    std::vector<StationPoint> once, often;
    for (int i = 0; i < 3000; ++i) {
        const double a = dice.between(0, 2 * pi), r = pipe_.radius + scan_noise * dice.normal();
        once.push_back({pipe_.point + Vec3d{r * std::cos(a), r * std::sin(a), dice.between(-0.5, 0.5)}, 0});
        for (int k = 0; k < 20; ++k) often.push_back(once.back());
    }
    std::vector<ShapeFit> fits;
    for (const auto* points : {&once, &often}) {
        write_stations_ply(folder_ / "some.ply", *points, Says::nothing);
        BuildOptions options;
        options.overwrite = true;
        build_tree({folder_ / "some.ply"}, folder_ / "some.pct", options);
        fits.push_back(fit(*PointCloud::open(folder_ / "some.pct"), pipe_).primitive.fit);
    }
    for (const ShapeFit& fit : fits) {
        ASSERT_TRUE(fit.has_shape()) << fit.message;
        EXPECT_LT(std::fabs(fit.shape.radius - pipe_.radius), 3 * fit.errors.radius);
    }
    EXPECT_NEAR(fits[1].errors.radius, fits[0].errors.radius, 0.4 * fits[0].errors.radius);
    EXPECT_NEAR(fits[1].errors.position, fits[0].errors.position, 0.4 * fits[0].errors.position);
}

// A ball that one station sees and a pipe of which each sees a third: points of different numbers are nowhere
// neighbours, so the numbers may as well be those of objects, and what is given is added to sizes, too.
TEST_F(StationErrors, PCM_NOT_UNDER_THREAD(StationsThatSeeNothingTogetherAreUnknown))
{
    const auto there = cloud(0.001, 8, Says::source_id, false);
    const FittedPrimitive points = fit(*there, ball_), given = fit(*there, ball_, 2);
    EXPECT_EQ(points.primitive.stations->source, StationSource::none);
    EXPECT_EQ(points.primitive.stations->freedom, 0u);
    EXPECT_NEAR(given.primitive.fit.errors.position, std::hypot(points.primitive.fit.errors.position, 0.002), 1e-7);
    EXPECT_NEAR(given.primitive.fit.errors.radius, std::hypot(points.primitive.fit.errors.radius, 0.002), 1e-7);
    EXPECT_NE(station_text(*given.primitive.stations).find("registration within 0.002"), std::string::npos);
    EXPECT_NE(station_text(*points.primitive.stations).find("not the registration"), std::string::npos);
}

TEST_F(StationErrors, ResultsDependOnNoThreads)
{
    const auto there = cloud(0.0015, 9, Says::source_id);
    FitAtOptions options;
    options.fit.kind = ShapeKind::cylinder;
    std::vector<ShapeErrors> errors;
    for (const unsigned threads : {1u, 4u}) {
        options.threads = threads;
        errors.push_back(fit_at(*there, {pipe_.point + Vec3d{-0.2, 0, 0}}, {}, options).primitive.fit.errors);
    }
    EXPECT_EQ(errors[0].position, errors[1].position);
    EXPECT_EQ(errors[0].radius, errors[1].radius);
}

TEST_F(StationErrors, RegistrationsBelowZeroAreRefused)
{
    const auto there = cloud(0, 1, Says::nothing, false);
    EXPECT_ANY_THROW(fit(*there, pipe_, -1));
    EXPECT_ANY_THROW(fit(*there, pipe_, infinity));
}

}  // namespace
