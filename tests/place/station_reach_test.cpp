// How far stations see, by boxes that their points fill.
#include "pcm/place/station_survey.h"

#include "tests/place/station_cloud.h"

#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

// Two rooms far from each other, and what they are for clouds that do not say where they were scanned from.
TEST(StationReach, IsHalfTheDiagonalOfWhatAStationSees)
{
    Dice dice(3);
    const TemporaryFolder folder;
    std::vector<StationPoint> points;
    const Vec3d half{4, 3, 1.5};
    for (int i = 0; i < 20000; ++i) {
        const Vec3d middle = hall + Vec3d{i % 2 ? 100.0 : 0.0, 0, 0};
        const auto along = [&](std::size_t k) { return half[k] * dice.between(-1, 1); };
        points.push_back({middle + Vec3d{along(0), along(1), along(2)}, i % 2});
    }
    for (const Says says : {Says::source_id, Says::nothing}) {
        write_stations_ply(folder / "rooms.ply", points, says);
        BuildOptions options;
        options.overwrite = true;
        build_tree({folder / "rooms.ply"}, folder / "rooms.pct", options);
        const auto tree = Tree::open(folder / "rooms.pct");
        const double reach = station_survey(*tree, PointStations(*tree), hall).reach;
        const double of_room = length(half), of_both = std::sqrt(3 * 50.0 * 50.0 + dot(half, half));
        const double expected = says == Says::source_id ? of_room : of_both;
        EXPECT_NEAR(reach, expected, 0.05 * expected);
    }
}

}  // namespace
