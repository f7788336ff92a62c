// What the errors of detected shapes contain of how far stations are apart: halls of known shapes and shifts.
#include "pcm/detect/detect.h"

#include "pcm/system/error.h"
#include "tests/detect/checked_labels.h"
#include "tests/place/station_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

pcm::Shape in_hall(ShapeKind kind, const Vec3d& point, const Vec3d& axis, double radius = 0)
{
    pcm::Shape s;
    s.kind = kind;
    s.point = hall + point;
    s.axis = axis;
    s.radius = radius;
    return s;
}

const pcm::Shape pipe_there = in_hall(ShapeKind::cylinder, {2, 0, 1}, {0, 0, 1}, 0.2);
const pcm::Shape ball_there = in_hall(ShapeKind::sphere, {-2, 0, 1}, {0, 0, 1}, 0.25);
const pcm::Shape ground_there = in_hall(ShapeKind::plane, {0, 0, 0}, {0, 0, 1});
const pcm::Shape wall_there = in_hall(ShapeKind::plane, {0, 4, 1}, {0, -1, 0});
const pcm::Shape side_there = in_hall(ShapeKind::plane, {4, 0, 1}, {-1, 0, 0});

// Largest number of a shape that is off, in its errors.
double worst_of(const ShapeFit& fit, const pcm::Shape& truth)
{
    const Vec3d d = traits_of(truth.kind).place_near(fit.shape, truth.point) - truth.point;
    double worst = length(d) / fit.errors.position;
    if (truth.kind == ShapeKind::plane)
        worst = std::fabs(dot(fit.shape.point - truth.point, truth.axis)) / fit.errors.position;
    if (traits_of(truth.kind).has_axis())
        worst = std::max(worst, length(cross(fit.shape.axis, truth.axis)) / fit.errors.angle);
    if (traits_of(truth.kind).has_radius())
        worst = std::max(worst, std::fabs(fit.shape.radius - truth.radius) / fit.errors.radius);
    return worst;
}

// Two walls and a floor that all stations see, a pipe of which each sees its side, and a ball that one sees.
class ErrorsOfStations : public testing::Test {
protected:
    void make(double spread, std::uint64_t seed, Says says)
    {
        Dice dice(seed);
        Vec3d shifts[3];
        for (Vec3d& shift : shifts) shift = {spread * dice.normal(), spread * dice.normal(), spread * dice.normal()};
        std::vector<StationPoint> points;
        const auto put = [&](const Vec3d& p, const Vec3d& n, int station) {
            points.push_back({p + scan_noise * dice.normal() * n + shifts[station], station});
        };
        for (int i = 0; i < 9000; ++i) {
            const double a = dice.between(0, 2 * pi);
            const Vec3d n{std::cos(a), std::sin(a), 0};
            put(pipe_there.point + Vec3d{0, 0, dice.between(-0.6, 0.6)} + pipe_there.radius * n, n,
                std::min(2, static_cast<int>(a / (2 * pi) * 3)));
        }
        for (int i = 0; i < 5000; ++i)
            if (const Vec3d n = dice.direction(); n[0] > -0.3) put(ball_there.point + ball_there.radius * n, n, 1);
        for (int i = 0; i < 60000; ++i) {
            const double a = dice.between(-4, 4), b = dice.between(-4, 4);
            if (i % 9 < 3) put(hall + Vec3d{a, b, 0}, {0, 0, 1}, i % 3);
            if (i % 9 >= 3 && i % 9 < 6) put(hall + Vec3d{a, 4, 1 + b / 4}, {0, -1, 0}, i % 3);
            if (i % 9 >= 6) put(hall + Vec3d{4, a, 1 + b / 4}, {-1, 0, 0}, i % 3);
        }
        build(points, says);
    }
    void build(const std::vector<StationPoint>& points, Says says)
    {
        tree_ = build_station_tree(folder_.path(), points, says);
    }
    DetectReport detect(double registration = 0, unsigned threads = 1) const
    {
        DetectOptions options;
        options.registration = registration;
        options.threads = threads;
        DetectReport report = detect_primitives(tree_, options);
        check_labels(*tree_, report);
        EXPECT_EQ(report.agreement.size(), report.primitives.size());
        return report;
    }
    static const Primitive* found(const DetectReport& report, const pcm::Shape& truth)
    {
        for (const Primitive& one : report.primitives)
            if (one.fit.shape.kind == truth.kind && distance_to(truth, one.fit.shape.point) < 0.05 + truth.radius &&
                std::fabs(dot(one.fit.shape.axis, truth.axis)) > (truth.kind == ShapeKind::sphere ? -1 : 0.9))
                return &one;
        return nullptr;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

TEST_F(ErrorsOfStations, PCM_NOT_UNDER_SANITIZERS(ShapesOfShiftedStationsLieWithinThreeOfThem))
{
    int all = 0, within = 0, of_noise = 0;
    double squares = 0;
    for (std::uint64_t seed = 20; seed < 28; ++seed) {
        make(0.0015, seed, Says::source_id);
        const DetectReport report = detect();
        for (const pcm::Shape& truth : {pipe_there, ball_there, ground_there, wall_there, side_there}) {
            const Primitive* const one = found(report, truth);
            ASSERT_TRUE(one) << traits_of(truth.kind).name << " " << seed;
            ASSERT_TRUE(one->stations);
            EXPECT_EQ(one->stations->source, StationSource::attribute);
            EXPECT_EQ(one->stations->stations, truth.kind == ShapeKind::sphere ? 1u : 3u);
            EXPECT_GE(one->stations->freedom, 4u);
            EXPECT_LT(std::fabs(std::log(one->stations->spread / 0.0015)), 0.9);
            const double worst = worst_of(one->fit, truth);
            ++all;
            within += worst <= 3;
            squares += std::pow(worst, 2);
            ShapeFit noise = one->fit;
            noise.errors.position = noise.errors.angle = noise.errors.radius =
                2 * scan_noise / std::sqrt(static_cast<double>(one->points));
            of_noise += worst_of(noise, truth) <= 3;
        }
    }
    EXPECT_GE(within, all * 95 / 100);
    EXPECT_LE(of_noise, all / 2) << "without the stations most are not";
    EXPECT_GT(squares / all, 0.4) << "and they are not too large";
}

TEST_F(ErrorsOfStations, PCM_NOT_UNDER_THREAD(StationsThatAreNotShiftedAddNextToNothing))
{
    make(0, 3, Says::source_id);
    const DetectReport report = detect();
    for (const pcm::Shape& truth : {pipe_there, ball_there, ground_there}) {
        const Primitive* const one = found(report, truth);
        ASSERT_TRUE(one);
        EXPECT_LT(one->stations->spread, 0.0002);
        EXPECT_LT(one->fit.errors.position, 0.00025);
        EXPECT_LE(worst_of(one->fit, truth), 4);
    }
}

TEST_F(ErrorsOfStations, PCM_NOT_UNDER_THREAD(WithoutStationsTheRegistrationThatIsGivenIsContained))
{
    make(0, 3, Says::nothing);
    const DetectReport without = detect(), with = detect(2);
    for (const pcm::Shape& truth : {pipe_there, ground_there}) {
        const Primitive *const one = found(without, truth), *const given = found(with, truth);
        ASSERT_TRUE(one && given);
        EXPECT_EQ(one->stations->source, StationSource::none);
        EXPECT_EQ(one->stations->stations, 0u);
        EXPECT_EQ(one->stations->contained(), 0);
        EXPECT_LT(one->fit.errors.position, 0.0003);
        EXPECT_EQ(given->stations->registration, 0.002);
        EXPECT_NEAR(given->fit.errors.position, std::hypot(one->fit.errors.position, 0.002), 1e-12);
    }
    DetectOptions options;
    options.registration = -1;
    EXPECT_THROW(detect_primitives(tree_, options), Error);
}

TEST_F(ErrorsOfStations, PCM_NOT_UNDER_THREAD(TheLargerOneOfWhatIsGivenAndSeenIsContained))
{
    make(0.0005, 4, Says::source_id);
    const DetectReport seen = detect(), given = detect(5);
    const Primitive *const by_stations = found(seen, ball_there), *const by_report = found(given, ball_there);
    ASSERT_TRUE(by_stations && by_report);
    EXPECT_LT(by_stations->fit.errors.position, 0.002);
    EXPECT_GT(by_report->fit.errors.position, 0.004) << "one station shifts the whole ball";
    EXPECT_LT(by_report->fit.errors.radius, 0.0005) << "and does not change its size";
}

TEST_F(ErrorsOfStations, PCM_NOT_UNDER_THREAD(TilesAreNotStations))
{
    make(0, 3, Says::tiles);
    const DetectReport report = detect();
    ASSERT_FALSE(report.primitives.empty());
    for (const Primitive& one : report.primitives) EXPECT_EQ(one.stations->source, StationSource::none);
}

TEST_F(ErrorsOfStations, PCM_NOT_UNDER_SANITIZERS(DoNotDependOnThreads))
{
    make(0.0015, 5, Says::time);
    const DetectReport one = detect(0, 1), four = detect(0, 4);
    ASSERT_EQ(one.primitives.size(), four.primitives.size());
    EXPECT_EQ(one.agreement, four.agreement);
    for (std::size_t i = 0; i < one.primitives.size(); ++i) {
        EXPECT_EQ(one.primitives[i].stations->source, StationSource::time_gaps);
        EXPECT_EQ(one.primitives[i].stations->spread, four.primitives[i].stations->spread);
        EXPECT_EQ(one.primitives[i].fit.errors.position, four.primitives[i].fit.errors.position);
        EXPECT_EQ(one.primitives[i].fit.errors.angle, four.primitives[i].fit.errors.angle);
        EXPECT_EQ(one.primitives[i].fit.shape.point, four.primitives[i].fit.shape.point);
    }
}

// Shifts bend a wall for as one cloud: neighbours agree there, and do not within their stations.
TEST_F(ErrorsOfStations, PCM_NOT_UNDER_THREAD(SharedErrorsAreThoseWithinStations))
{
    Dice dice(8);
    std::vector<StationPoint> points;
    for (int i = 0; i < 60000; ++i) {
        const double x = dice.between(0, 6), y = dice.between(0, 3);
        // Two stations see all of it and a third one its end.
        const int station = x > 4 && i % 2 == 0 ? 2 : i % 4 / 2;
        const double shift[] = {0.0015, -0.001, 0.003};
        points.push_back({hall + Vec3d{x, y, scan_noise * dice.normal() + shift[station]}, station});
    }
    build(points, Says::source_id);
    const DetectReport with = detect();
    build(points, Says::nothing);
    const DetectReport without = detect();
    ASSERT_EQ(with.primitives.size(), 1u);
    ASSERT_EQ(without.primitives.size(), 1u);
    EXPECT_GT(without.agreement[0], 3);
    EXPECT_LT(with.agreement[0], 1.5);
    EXPECT_GE(with.agreement[0], 1);
}

// A thin pipe whose errors lie along the rays comes out too thin.
TEST_F(ErrorsOfStations, PCM_NOT_UNDER_THREAD(ErrorsAlongRaysAreTakenFromPipes))
{
    Dice dice(9);
    std::vector<StationPoint> points;
    const double radius = 0.05, noise = 0.004;
    for (int i = 0; i < 30000; ++i) {
        const double across = dice.between(-1, 1), a = std::asin(0.97 * across);
        points.push_back({hall + Vec3d{radius * std::sin(a), dice.between(0, 3), -radius * std::cos(a)} +
                              Vec3d{0, 0, noise * dice.normal()},
                          1});
    }
    build(points, Says::nothing);
    const DetectReport report = detect();
    const Primitive* const one = found(report, in_hall(ShapeKind::cylinder, {0, 1.5, 0}, {0, 1, 0}, radius));
    ASSERT_TRUE(one);
    EXPECT_GT(one->stations->ray_share, 0.3);
    EXPECT_LT(std::fabs(one->fit.shape.radius - radius), 0.0004) << "least squares alone: 1 mm too thin";
    EXPECT_LE(std::fabs(one->fit.shape.radius - radius), 3 * one->fit.errors.radius);
    EXPECT_GE(report.outcome.error, one->fit.threshold);
}

}  // namespace
