// An oval pipe is one for each of the stations that see it; a round one that stations see apart is none.
#include "pcm/place/station_departure.h"
#include "pcm/place/fit_at.h"
#include "pcm/query/point_set.h"
#include "tests/place/station_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

class StationDeparture : public testing::Test {
protected:
    static constexpr double radius = 0.28;

    // A pipe with half axes that differ by `oval` from its radius, between walls. Three stations see it from three
    // sides, half of it each.
    std::shared_ptr<PointCloud> cloud(double oval, double spread, std::uint64_t seed)
    {
        Dice dice(seed);
        std::vector<Vec3d> shifts;
        for (int s = 0; s < 3; ++s)
            shifts.push_back({spread * dice.normal(), spread * dice.normal(), spread * dice.normal()});
        std::vector<StationPoint> points;
        const auto put = [&](const Vec3d& p, const Vec3d& n, int station) {
            points.push_back({p + scan_noise * dice.normal() * n + shifts[static_cast<std::size_t>(station)], station});
        };
        for (int i = 0; i < 12000; ++i) {
            const int station = single_ ? 0 : i % 3;
            const double a = 2 * pi / 3 * station + dice.between(-pi / 2, pi / 2);
            const Vec3d n{std::cos(a), std::sin(a), 0};
            put(hall + Vec3d{0, 0, dice.between(0.2, 2)} + (radius + oval * std::cos(2 * a)) * n, n, station);
        }
        for (int i = 0; i < 40000; ++i) {
            const double a = dice.between(-4, 4), b = dice.between(-4, 4);
            const int station = i % 3;
            if (i % 9 < 3)
                put(hall + Vec3d{a, b, -1}, {0, 0, 1}, station);
            else if (i % 9 < 6)
                put(hall + Vec3d{a, 4, 1 + b / 4}, {0, -1, 0}, station);
            else
                put(hall + Vec3d{4, a, 1 + b / 4}, {-1, 0, 0}, station);
        }
        build_station_tree(folder_.path(), points, Says::source_id);
        return PointCloud::open(folder_ / "stations.pct");
    }

    // The pipe's points, relative to the best round one.
    Departure departure(double oval, double spread)
    {
        const auto found = cloud(oval, spread, 3);
        ShapeFit fit;
        fit.shape.kind = ShapeKind::cylinder;
        fit.shape.point = hall;
        fit.shape.radius = radius;
        fit.threshold = 0.05;
        const PointSet pipe = set_where(found->tree(), [&](const Vec3d& p) {
            return p[2] > hall[2] + 0.1 && std::hypot(p[0] - hall[0], p[1] - hall[1]) < 0.5;
        });
        return departure_within_stations(pipe, fit, PointStations(*found->tree()),
                                         {std::max(spread, 0.005), scan_noise}, {}, 1, {});
    }

    FittedPrimitive fitted(double oval, double spread, std::uint64_t seed)
    {
        FitAtOptions options;
        options.fit.kind = ShapeKind::cylinder;
        options.threads = 2;
        return fit_at(*cloud(oval, spread, seed), {hall + Vec3d{radius, 0, 1}}, {}, options);
    }

    TemporaryFolder folder_;
    bool single_ = false;  // one station sees the pipe
};

TEST_F(StationDeparture, ShiftsOfStationsAreTakenAway)
{
    const Departure round = departure(0, 0.005);
    EXPECT_GT(round.points, 1000u);
    EXPECT_FALSE(round.is_smooth(scan_noise)) << round.share << " " << round.size;
    EXPECT_NEAR(round.rest, scan_noise, 0.1 * scan_noise);
}

TEST_F(StationDeparture, AnOvalIsLeft)
{
    for (const double spread : {0.0, 0.005}) {
        const Departure oval = departure(0.006, spread);
        EXPECT_TRUE(oval.is_smooth(scan_noise)) << oval.share << " " << oval.size << " " << oval.agreement;
        EXPECT_NEAR(oval.rest, scan_noise, 0.1 * scan_noise);
        EXPECT_GT(oval.size, 0.001);
    }
}

// No shift makes what one station sees out of round: before, nothing was left of it.
TEST_F(StationDeparture, AnOvalThatOneStationSeesIsLeft)
{
    single_ = true;
    EXPECT_TRUE(departure(0.006, 0).is_smooth(scan_noise));
    EXPECT_FALSE(departure(0, 0).is_smooth(scan_noise));
}

TEST_F(StationDeparture, PCM_NOT_UNDER_SANITIZERS(AClickOnAnOvalPipeOfShiftedStationsIsDoubted))
{
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const ShapeFit oval = fitted(0.01, 0.006, seed).primitive.fit;
        EXPECT_NE(oval.verdict, FitVerdict::good) << seed << " noise " << oval.noise;
        const ShapeFit round = fitted(0, 0.0015, seed).primitive.fit;
        EXPECT_EQ(round.verdict, FitVerdict::good) << seed << " " << round.message;
    }
}

}  // namespace
