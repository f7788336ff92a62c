// Planes whose stations see the two faces of a plate.
#include "pcm/place/station_sides.h"

#include "pcm/place/fit_at.h"
#include "tests/place/station_cloud.h"
#include "tests/sanitizers.h"

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double side_noise = 0.0013;

// `stations` stations, each shifted along the normal; every second one sees the face at height `thickness`.
std::vector<PointOfStation> seen_plate(int stations, double thickness, double spread, std::size_t each, Dice& dice)
{
    std::vector<PointOfStation> points;
    for (int station = 0; station < stations; ++station) {
        const double height = spread * dice.normal() + (station % 2 == 1 ? thickness : 0);
        for (std::size_t i = 0; i < each; ++i)
            points.push_back({{dice.unit(), dice.unit(), height + side_noise * dice.normal()},
                              static_cast<std::uint32_t>(station + 7)});
    }
    return points;
}

pcm::Shape level(double height)
{
    pcm::Shape plane;
    plane.point = {0, 0, height};
    plane.axis = {0, 0, 1};
    return plane;
}

TEST(StationSides, TheFacesOfAPlateAreTwo)
{
    Dice dice(3);
    for (const double spread : {0.0, 0.0015})
        for (const double thickness : {0.008, 0.012}) {
            int two = 0;
            for (int round = 0; round < 50; ++round)
                two += station_sides(level(thickness / 2), seen_plate(9, thickness, spread, 100, dice))
                           .are_two(side_noise, spread);
            EXPECT_GE(two, spread > 0 && thickness < 0.01 ? 30 : 48) << thickness << " " << spread;
        }
    const StationSides sides = station_sides(level(0.004), seen_plate(8, 0.008, 0, 400, dice));
    EXPECT_NEAR(sides.apart, 0.008, 0.0002);
    EXPECT_NEAR(sides.gap, 0.008, 0.0004);
    EXPECT_NEAR(sides.within, side_noise, 0.1 * side_noise);
    EXPECT_NEAR(sides.share, 0.5, 0.01);
}

// Whatever their number, and however far they are apart.
TEST(StationSides, OneFaceIsOne)
{
    Dice dice(4);
    for (const int stations : {2, 3, 5, 9})
        for (const double spread : {0.0, 0.0015, 0.006}) {
            int two = 0;
            for (int round = 0; round < 200; ++round)
                two += station_sides(level(0), seen_plate(stations, 0, spread, 60, dice)).are_two(side_noise, spread);
            EXPECT_LE(two, 18) << stations << " stations " << spread << " apart";
        }
    EXPECT_FALSE(station_sides(level(0), seen_plate(1, 0, 0.002, 60, dice)).are_two(side_noise, 0));
    EXPECT_FALSE(station_sides(level(0), {}).are_two(side_noise, 0));
}

// A few points of what stands next to the plane, as another station sees it, do not make it one of two faces.
TEST(StationSides, FewPointsDoNotCount)
{
    Dice dice(5);
    std::vector<PointOfStation> points = seen_plate(5, 0, 0, 400, dice);
    const auto add = [&](std::uint32_t station, int count) {
        for (int i = 0; i < count; ++i) points.push_back({{dice.unit(), dice.unit(), 0.02}, station});
    };
    add(100, 19);
    EXPECT_LT(station_sides(level(0), points).apart, 0.001) << "too few for a station";
    add(101, 100);
    EXPECT_GT(station_sides(level(0), points).apart, 0.015);
    EXPECT_FALSE(station_sides(level(0), points).are_two(side_noise, 0)) << "a twentieth of the points";
    add(101, 300);
    EXPECT_TRUE(station_sides(level(0), points).are_two(side_noise, 0));
}

// Where the surfaces around are plates, too, their stations seem to be as far apart; but stations are not in two
// groups.
TEST(StationSides, GroupsOfStationsAreNoRegistration)
{
    Dice dice(6);
    int plates = 0, faces = 0;
    for (int round = 0; round < 200; ++round) {
        plates += station_sides(level(0.004), seen_plate(8, 0.008, 0.0003, 60, dice)).are_two(side_noise, 0.004);
        faces += station_sides(level(0), seen_plate(8, 0, 0.004, 60, dice)).are_two(side_noise, 0.004);
    }
    EXPECT_EQ(plates, 200);
    EXPECT_LE(faces, 16);
    const StationSides three = station_sides(level(0.004), seen_plate(3, 0.008, 0, 60, dice));
    EXPECT_FALSE(three.are_two(side_noise, 0.004)) << "one station of three";
    std::vector<PointOfStation> one = seen_plate(5, 0, 0.0001, 60, dice);
    for (PointOfStation& p : one)
        if (p.station == 9) p.place[2] += 0.008;
    EXPECT_FALSE(station_sides(level(0), one).are_two(side_noise, 0.004)) << "one station far from four";
}

// Where points next to the plane are among those of its stations, the noise of smooth surfaces is the measure.
TEST(StationSides, TheLesserNoiseCounts)
{
    StationSides sides;
    sides.apart = 0.0066;
    sides.gap = 0.0058;
    sides.within = 0.0032;
    sides.share = 0.4;
    EXPECT_FALSE(sides.are_two(0, 0));
    EXPECT_TRUE(sides.are_two(0.0013, 0));
    EXPECT_FALSE(sides.are_two(0.0013, 0.003));
    sides.within = 0.001;
    EXPECT_TRUE(sides.are_two(0.01, 0));
    sides.gap = 0.002;
    EXPECT_FALSE(sides.are_two(0.0013, 0)) << "stations anywhere between them";
}

// The web of an I-beam, 7 mm thick, whose faces are seen by four stations each; its flanges by all.
std::vector<StationPoint> seen_beam(Dice& dice)
{
    constexpr double length = 4, density = 1 / (0.012 * 0.012);
    std::vector<StationPoint> points;
    const auto add = [&](double width, bool has_sides, const auto& at) {
        for (int i = 0; i < static_cast<int>(length * width * density); ++i) {
            const Vec3d p = at();
            const int station = 2 * static_cast<int>(4 * dice.unit());
            const bool is_behind = has_sides ? p[1] > 0 : dice.unit() < 0.5;
            points.push_back({hall + Vec3d{dice.between(0, length), 0, 0} + p, station + is_behind});
        }
    };
    const auto away = [&] { return side_noise * dice.normal(); };
    for (const double side : {-0.0035, 0.0035})
        add(0.2, true, [&] { return Vec3d{0, side + 0.7 * away(), dice.between(-0.1, 0.1)}; });
    for (const double flange : {-0.1, 0.1})
        add(0.12, false, [&] { return Vec3d{0, dice.between(-0.06, 0.06), flange + away()}; });
    return points;
}

// Not the middle between them.
TEST(StationSides, PCM_NOT_UNDER_SANITIZERS(AClickOnAWebIsAnsweredByTheFaceAtThePlace))
{
    int right = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
        Dice dice(seed);
        const std::vector<StationPoint> points = seen_beam(dice);
        const TemporaryFolder folder;
        write_stations_ply(folder / "beam.ply", points, Says::source_id);
        build_tree({folder / "beam.ply"}, folder / "beam.pct", {});
        const auto cloud = PointCloud::open(folder / "beam.pct");
        FitAtOptions options;
        options.kinds = any_kind().kinds;
        for (const double z : {-0.08, -0.03, 0.02, 0.07})
            for (const double side : {-0.0035, 0.0035}) {
                const Vec3d place = hall + Vec3d{2, side, z};
                const FittedPrimitive found = fit_at(*cloud, {place}, {}, options);
                const ShapeFit& fit = found.primitive.fit;
                if (fit.verdict != FitVerdict::good) continue;
                ASSERT_EQ(fit.shape.kind, ShapeKind::plane);
                EXPECT_LT(distance_to(fit.shape, place), 0.0003) << z << " " << side;
                EXPECT_GT(found.points.size(), 2000u) << "of 5,555";
                ++right;
            }
    }
    EXPECT_GE(right, 18) << "of 24";
}

}  // namespace
