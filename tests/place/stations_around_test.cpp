// The noise of the surfaces around a place.
#include "pcm/place/stations_around.h"

#include "pcm/cloud/numbers.h"
#include "tests/place/station_cloud.h"

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

// A wall that two stations see, which are 4 mm apart across it.
std::vector<StationPoint> wall(double apart, Dice& dice)
{
    std::vector<StationPoint> points;
    for (int i = 0; i < 6000; ++i) {
        const double shift = i % 2 ? apart / 2 : -apart / 2;
        points.push_back(
            {hall + Vec3d{dice.between(0, 2), shift + scan_noise * dice.normal(), dice.between(0, 2)}, i % 2});
    }
    return points;
}

double surface_noise(const std::vector<StationPoint>& points, Says says, double* noise = nullptr)
{
    TemporaryFolder folder;
    write_stations_ply(folder / "wall.ply", points, says);
    build_tree({folder / "wall.ply"}, folder / "wall.pct", {});
    const auto tree = Tree::open(folder / "wall.pct");
    StationsAround around(*tree, points.front().position);
    if (noise) *noise = around.survey().noise();
    return around.surface_noise();
}

TEST(StationsAround, SurfacesAroundShowTheNoise)
{
    Dice dice(4);
    double noise = 0;
    const double quiet = surface_noise(wall(0, dice), Says::nothing, &noise);
    EXPECT_NEAR(quiet, 2 * scan_noise, 0.2 * scan_noise);
    EXPECT_NEAR(noise, scan_noise, 0.1 * scan_noise);
    // Stations that are not known are part of the noise; known ones are apart.
    const double unknown = surface_noise(wall(0.004, dice), Says::nothing, &noise);
    EXPECT_NEAR(unknown, 2 * noise, 1e-12);
    EXPECT_NEAR(noise, std::hypot(scan_noise, 0.002), 0.15 * scan_noise);
    const double named = surface_noise(wall(0.004, dice), Says::source_id, &noise);
    EXPECT_NEAR(noise, scan_noise, 0.1 * scan_noise);
    EXPECT_GT(named, std::hypot(2 * noise, 0.001));
}

TEST(StationsAround, FewPointsShowNone)
{
    Dice dice(5);
    std::vector<StationPoint> points = wall(0, dice);
    points.resize(6);
    double noise = 1;
    EXPECT_EQ(surface_noise(points, Says::nothing, &noise), infinity);
    EXPECT_EQ(noise, 0);
}

}  // namespace
