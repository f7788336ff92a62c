// Planes whose stations see the two faces of a plate.
#include "pcm/place/station_sides.h"

#include "tests/place/shape_cloud.h"

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

// Where points next to the plane are among those of its stations, the noise of smooth surfaces is the measure.
TEST(StationSides, TheLesserNoiseCounts)
{
    StationSides sides{0.0066, 0.0058, 0.0032, 0.4};
    EXPECT_FALSE(sides.are_two(0, 0));
    EXPECT_TRUE(sides.are_two(0.0013, 0));
    EXPECT_FALSE(sides.are_two(0.0013, 0.003));
    sides.within = 0.001;
    EXPECT_TRUE(sides.are_two(0.01, 0));
    sides.gap = 0.002;
    EXPECT_FALSE(sides.are_two(0.0013, 0)) << "stations anywhere between them";
}

}  // namespace
