// Which attribute or gap of times says from which station a point is, and what the surfaces around say of two stations.
#include "pcm/place/point_stations.h"
#include "pcm/io/scans.h"
#include "pcm/place/station_survey.h"
#include "pcm/place/stations_around.h"
#include "tests/memory_reader.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;

// Numbers of a point; those that are not written are not in the cloud.
struct Numbers {
    std::uint32_t scan = 0;
    std::uint16_t source_id = 0;
    double time = 0;
    Vec3d place{};
};

class PointStationsTest : public testing::Test {
protected:
    using Make = std::function<Numbers(int i)>;
    // The points i = 0 ... count - 1. `has`: letters s (scan), p (point_source_id), t (gps_time).
    std::shared_ptr<const Tree> tree(const std::string& has, int count, const Make& make, std::uint32_t chunk = 1000)
    {
        const auto wants = [&](char letter) { return has.find(letter) != std::string::npos; };
        std::ofstream file(folder_ / "in.ply", std::ios::binary);
        file << "ply\nformat binary_little_endian 1.0\nelement vertex " << count << "\n";
        for (const char* axis : {"x", "y", "z"}) file << "property double " << axis << "\n";
        if (wants('s')) file << "property uint scan\n";
        if (wants('p')) file << "property ushort point_source_id\n";
        if (wants('t')) file << "property double gps_time\n";
        file << "end_header\n";
        for (int i = 0; i < count; ++i) {
            const Numbers n = make(i);
            file.write(reinterpret_cast<const char*>(n.place.data()), 24);
            if (wants('s')) file.write(reinterpret_cast<const char*>(&n.scan), 4);
            if (wants('p')) file.write(reinterpret_cast<const char*>(&n.source_id), 2);
            if (wants('t')) file.write(reinterpret_cast<const char*>(&n.time), 8);
        }
        file.close();
        BuildOptions options;
        options.chunk_points = chunk;
        options.overwrite = true;
        build_tree({folder_ / "in.ply"}, folder_ / "in.pct", options);
        return Tree::open(folder_ / "in.pct");
    }
    // The same with places all over a square.
    std::shared_ptr<const Tree> square(const std::string& has, int count, const Make& make)
    {
        return tree(has, count, [&](int i) {
            Numbers numbers = make(i);
            numbers.place = {dice_.between(0, 10), dice_.between(0, 10), 0};
            return numbers;
        });
    }
    TemporaryFolder folder_;
    Dice dice_{4};
};

// The station of each point, of a tree whose points' x is the expected one.
std::size_t wrong_stations(const Tree& tree, const PointStations& stations)
{
    std::size_t wrong = 0;
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        const Chunk chunk = tree.read_chunk(node, stations.columns());
        for (std::uint32_t i = 0; i < chunk.points; ++i)
            wrong += stations.at(chunk, i) != std::lround(tree.info().grid.to_source(chunk.positions->grid(i))[0]);
    }
    return wrong;
}

TEST_F(PointStationsTest, TheFirstAttributeOfSeveralValuesSaysIt)
{
    const auto two = tree("sp", 2000, [](int i) {
        return Numbers{70000u + static_cast<unsigned>(i % 2),
                       static_cast<std::uint16_t>(i % 3),
                       0,
                       {70000.0 + i % 2, 0.01 * i, 0}};
    });
    const PointStations scans(*two);
    EXPECT_EQ(scans.source(), StationSource::attribute);
    EXPECT_EQ(scans.attribute(), "scan");
    EXPECT_TRUE(scans.columns().positions);
    EXPECT_EQ(wrong_stations(*two, scans), 0u);
    const auto one_scan = tree("sp", 2000, [](int i) {
        return Numbers{5, static_cast<std::uint16_t>(i % 3), 0, {i % 3 + 0.0, 0.01 * i, 0}};
    });
    const PointStations ids(*one_scan);
    EXPECT_EQ(ids.attribute(), "point_source_id");
    EXPECT_EQ(wrong_stations(*one_scan, ids), 0u);
    const auto nothing = square("sp", 500, [](int) { return Numbers{5, 7, 0, {}}; });
    EXPECT_EQ(PointStations(*nothing).source(), StationSource::none);
    EXPECT_EQ(PointStations(*nothing).attribute(), "");
    EXPECT_TRUE(PointStations(*nothing).columns().positions);
    EXPECT_TRUE(PointStations(*nothing).columns().attributes.none());
    EXPECT_EQ(PointStations(*square("", 500, [](int) { return Numbers(); })).source(), StationSource::none);
}

// Eight points a station are enough, on the average; all points are in one chunk.
TEST_F(PointStationsTest, NumbersOfFewPointsNameSomethingElse)
{
    const auto source = [&](int points, int numbers) {
        return PointStations(*square("p", points,
                                     [=](int i) {
                                         return Numbers{0, static_cast<std::uint16_t>(i % numbers), 0, {}};
                                     }))
            .source();
    };
    EXPECT_EQ(source(80, 10), StationSource::attribute);
    EXPECT_EQ(source(79, 10), StationSource::none);
    EXPECT_EQ(source(16, 2), StationSource::attribute);
}

TEST_F(PointStationsTest, GapsAreHalfAMinuteAndFiftyMeanGaps)
{
    // Three blocks of 300 points, `apart` seconds from one to the next, points of a block `step` apart.
    const auto blocks = [&](double step, double apart) {
        return tree("t", 900, [=](int i) {
            const int block = i / 300;
            return Numbers{0, 0, 1e6 + block * (299 * step + apart) + i % 300 * step, {block + 0.0, 0.01 * i, 0}};
        });
    };
    const auto apart = blocks(0.01, 31);
    const PointStations stations(*apart);
    EXPECT_EQ(stations.source(), StationSource::time_gaps);
    EXPECT_EQ(stations.attribute(), "gps_time");
    EXPECT_TRUE(stations.columns().positions);
    EXPECT_EQ(wrong_stations(*apart, stations), 0u);
    EXPECT_EQ(PointStations(*blocks(0.01, 29)).source(), StationSource::none);
    // Mean gaps: 1 second between points, and a little more for the two gaps.
    EXPECT_EQ(PointStations(*blocks(1, 45)).source(), StationSource::none);
    EXPECT_EQ(PointStations(*blocks(1, 65)).source(), StationSource::time_gaps);
}

// Seconds are numbers times a scale, and an offset.
TEST_F(PointStationsTest, TimesAreScaledNumbers)
{
    MemoryCloud cloud;
    cloud.info.schema.add({"gps_time", ScalarType::i32, 1, 0.5, 1000, ""});
    cloud.info.points = 400;
    cloud.info.points_known = true;
    shape_batch(cloud.points, cloud.info.schema, false, 400);
    for (std::size_t i = 0; i < 400; ++i) {
        cloud.points.xyz[0][i] = i < 200 ? 0 : 1;
        cloud.points.xyz[1][i] = 0.01 * static_cast<double>(i);
        cloud.points.xyz[2][i] = 0;
        // 62 steps of half a second apart, or 58.
        cloud.points.attributes[0].as<std::int32_t>()[i] = i < 200 ? -5000 : -5000 + 62;
    }
    const auto built = [&] {
        BuildOptions options;
        options.overwrite = true;
        MemoryReader reader(cloud);
        build_tree(reader, {"memory"}, folder_ / "m.pct", options);
        return Tree::open(folder_ / "m.pct");
    };
    const auto apart = built();
    const PointStations stations(*apart);
    EXPECT_EQ(stations.source(), StationSource::time_gaps);
    EXPECT_EQ(wrong_stations(*apart, stations), 0u);
    for (std::size_t i = 200; i < 400; ++i) cloud.points.attributes[0].as<std::int32_t>()[i] -= 4;
    EXPECT_EQ(PointStations(*built()).source(), StationSource::none);
}

TEST_F(PointStationsTest, TimesThatAreNotFiniteAreIgnored)
{
    const auto with = tree("t", 600, [](int i) {
        const double time = i % 5 == 0   ? std::numeric_limits<double>::quiet_NaN()
                            : i % 7 == 0 ? std::numeric_limits<double>::infinity()
                                         : 0.01 * i + (i < 300 ? 0 : 100);
        return Numbers{0, 0, time, {i % 5 == 0 || i % 7 == 0 || i >= 300 ? 1.0 : 0.0, 0.01 * i, 0}};
    });
    const PointStations stations(*with);
    EXPECT_EQ(stations.source(), StationSource::time_gaps);
    // A time that is not finite is after all others.
    EXPECT_EQ(wrong_stations(*with, stations), 0u);
    const auto none = square("t", 100, [](int) { return Numbers{0, 0, std::nan(""), {}}; });
    EXPECT_EQ(PointStations(*none).source(), StationSource::none);
}

// A room of a floor and two walls, which two stations see with noise; the second one is shifted.
class StationSurveyTest : public PointStationsTest {
protected:
    static constexpr double noise = 0.0005;
    static constexpr Vec3d shift{0.004, -0.006, 0.005};
    // `change` moves a place of a station.
    StationSpread survey(const std::function<void(Vec3d& place, int station)>& change = {}, const Vec3d& middle = {})
    {
        const auto room = tree(
            "p", 12000,
            [&](int i) {
                const int station = i / 3 % 2;
                const double a = dice_.between(0, 4), b = dice_.between(0, 4), off = noise * dice_.normal();
                Vec3d place = i % 3 == 0 ? Vec3d{a, b, off} : i % 3 == 1 ? Vec3d{off, a, b} : Vec3d{a, off, b};
                if (station == 1) place = place + shift;
                if (change) change(place, station);
                return Numbers{0, static_cast<std::uint16_t>(8 + station), 0, middle + place};
            },
            3000);
        return station_survey(*room, PointStations(*room), middle + Vec3d{2, 2, 0}).evidence().spread();
    }
};

TEST_F(StationSurveyTest, IsReadOnceAPlace)
{
    const auto room = tree("p", 6000, [&](int i) {
        const Vec3d place{dice_.between(0, 4), dice_.between(0, 4), noise * dice_.normal()};
        return Numbers{0, static_cast<std::uint16_t>(8 + i % 2), 0, place};
    });
    StationsAround around(*room, {2, 2, 0});
    const std::uint64_t before = room->reads().chunks;
    EXPECT_TRUE(around.are_named());
    const std::uint64_t once = room->reads().chunks;
    EXPECT_GT(once, before);
    EXPECT_EQ(around.survey().evidence().stations(), 2u);
    EXPECT_EQ(around.points().source(), StationSource::attribute);
    EXPECT_EQ(room->reads().chunks, once);
}

TEST_F(StationSurveyTest, ShiftsAreThoseOfTheWalls)
{
    for (const Vec3d& middle : {Vec3d{}, Vec3d{454321, 5412345, 310}}) {
        const StationSpread found = survey({}, middle);
        EXPECT_EQ(found.stations, 2u);
        EXPECT_EQ(found.freedom, 3u);
        ASSERT_EQ(found.shifts.size(), 2u);
        EXPECT_LT(length(found.shifts.at(9) - found.shifts.at(8) - shift), 0.0006);
        EXPECT_LT(length(found.shifts.at(9) + found.shifts.at(8)), 0.0002) << "half of it each";
        // Three differences of 0.005 on the average, each of two shifts.
        EXPECT_NEAR(found.spread, length(shift) / std::sqrt(6.0), 0.0003);
    }
}

// A door that one station sees closed and the other open, and things that lie on the floor for one of them only.
TEST_F(StationSurveyTest, WhatContradictsTheOthersIsLeftOut)
{
    const StationSpread found = survey([](Vec3d& place, int station) {
        if (station != 1) return;
        if (place[0] < 0.02 && place[1] < 1.2 && place[2] > 0.1) place[0] += 0.08;
        if (place[2] < 0.02 && place[0] > 3 && place[1] > 3) place[2] += 0.06;
    });
    EXPECT_LT(length(found.shifts.at(9) - found.shifts.at(8) - shift), 0.0003);
}

// Stations at both sides of plates see another face of each, as far apart everywhere. So far apart stations are not
// along other axes, unless the shape that is fitted shows it.
TEST_F(StationSurveyTest, BothFacesOfPlatesAreLeftOut)
{
    const auto patch = [](const Vec3d& normal, double difference) {
        StationPatch made;
        made.stations = {3, 7};
        made.normal = normal;
        made.h = {10, -10, -10, 10};
        made.u = {-10 * difference, 10 * difference};
        made.noise = 0.001;
        return made;
    };
    StationSurvey survey;
    for (int i = 0; i < 30; ++i) survey.patches.push_back(patch({0, 0, 1}, i % 2 ? 1e-4 : -1e-4));
    for (int i = 0; i < 8; ++i) survey.patches.push_back(patch({1, 0, 0}, 0.02 + 1e-5 * i));
    EXPECT_LT(survey.evidence().spread().spread, 0.0003);
    for (int i = 0; i < 8; ++i) survey.patches.push_back(patch({0, 1, 0}, 0.0006 + 1e-5 * i));
    EXPECT_GT(survey.evidence().spread().spread, 0.0002) << "along one axis more than along another";
    StationEvidence known;
    std::vector<double> h(36, 0.0);
    for (std::size_t a = 0; a < 3; ++a) {
        h[6 * a + a] = h[6 * (a + 3) + a + 3] = 1000;
        h[6 * a + a + 3] = h[6 * (a + 3) + a] = -1000;
    }
    known.add({3, 7}, h, {-20, 0, 0, 20, 0, 0}, 0.001);
    EXPECT_GT(survey.evidence(known).spread().spread, 0.004);
    survey.patches.clear();
    EXPECT_EQ(survey.evidence(known).spread().spread, known.spread().spread);
}

// A vault whose heights within a cube are forty times its noise: heights of the second degree explain them. It is as
// smooth as the floor then, and alone shows the shifts along it.
TEST_F(StationSurveyTest, CurvedSurfacesAreAsSmoothAsFlatOnes)
{
    const auto vault = tree(
        "p", 12000,
        [&](int i) {
            const int station = i / 3 % 2;
            const double a = dice_.between(0.2, 1.4), b = dice_.between(0, 4), off = noise * dice_.normal();
            Vec3d place = i % 3 == 0 ? Vec3d{dice_.between(0, 3), dice_.between(0, 3), off}
                                     : Vec3d{(3 + off) * std::cos(a), (3 + off) * std::sin(a), b};
            if (station == 1) place = place + shift;
            return Numbers{0, static_cast<std::uint16_t>(8 + station), 0, place};
        },
        3000);
    const StationSpread found = station_survey(*vault, PointStations(*vault), {2, 2, 1}).evidence().spread();
    EXPECT_EQ(found.freedom, 3u);
    EXPECT_LT(length(found.shifts.at(9) - found.shifts.at(8) - shift), 0.0003);
    EXPECT_NEAR(found.spread, length(shift) / std::sqrt(6.0), 0.0003);
}

TEST_F(StationSurveyTest, StationsThatSeeDifferentPartsOfAWallAreNotCompared)
{
    const auto evidence = [&](const std::function<Vec3d(int i)>& place) {
        const auto made = tree(
            "p", 12000,
            [&](int i) {
                return Numbers{0, static_cast<std::uint16_t>(i % 2), 0, place(i)};
            },
            3000);
        const PointStations stations(*made);
        EXPECT_EQ(stations.source(), StationSource::attribute);
        if (stations.source() == StationSource::none) return std::size_t{99};
        return station_survey(*made, stations, {}).evidence().stations();
    };
    const auto any = [&] { return dice_.between(0, 1); };
    const auto small = [&] { return 0.001 * dice_.normal(); };
    EXPECT_EQ(evidence([&](int) { return Vec3d{any(), any(), small()}; }), 2u) << "a wall";
    EXPECT_EQ(evidence([&](int i) { return Vec3d{any() + i % 2, any(), small()}; }), 0u) << "halves of a wall";
}

// Points of a floor that have a number of their own, or with a chance that of their square: the nearest one of a
// point has another number less often than by chance, the less the more numbers are those of squares.
TEST_F(StationSurveyTest, NumbersOfPlacesAreNoStations)
{
    const auto names = [&](int points, double of_squares, double edge = 0.2) {
        const auto made = tree(
            "p", points,
            [&](int) {
                const Vec3d place{dice_.between(0, 4), dice_.between(0, 4), noise * dice_.normal()};
                const int square = static_cast<int>(place[0] / edge) + static_cast<int>(place[1] / edge);
                const int number = dice_.unit() < of_squares ? square % 2 : dice_.unit() < 0.5;
                return Numbers{0, static_cast<std::uint16_t>(number), 0, place};
            },
            8000);
        return station_survey(*made, PointStations(*made), {}).names_stations;
    };
    EXPECT_TRUE(names(8000, 0));
    EXPECT_TRUE(names(8000, 0.3)) << "nine in ten of the neighbours by chance";
    EXPECT_FALSE(names(8000, 0.55)) << "seven in ten";
    EXPECT_FALSE(names(8000, 1));
    EXPECT_FALSE(names(1400, 1)) << "700 by chance";
    EXPECT_FALSE(names(200, 1, 1.5)) << "100 by chance";
    EXPECT_TRUE(names(80, 1, 1.5)) << "40 by chance say nothing";
}

// Half of a floor is seen by one station alone, as where the view of another ends or something stands before it, in
// stripes: patches across their borders are mixed less than by chance.
TEST_F(StationSurveyTest, StationsThatSeePartsOfASurfaceAreStations)
{
    const auto made = tree(
        "p", 12000,
        [&](int) {
            const Vec3d place{dice_.between(0, 6), dice_.between(0, 6), noise * dice_.normal()};
            const bool is_both = std::fmod(place[0], 1) < 0.6;
            return Numbers{0, static_cast<std::uint16_t>(is_both ? dice_.unit() < 0.5 : 0), 0, place};
        },
        12000);
    EXPECT_TRUE(station_survey(*made, PointStations(*made), {}).names_stations);
}

// A floor of 12 m that two stations 8 mm apart in height see, but for a dense corner: its squares are one station's
// each, or all of it is. A place there shows other places what it cannot show itself.
TEST_F(StationSurveyTest, OtherPlacesShowWhatOneDoesNot)
{
    enum class Corner { squares, one };
    const auto floor = [&](Corner corner, bool is_mixed_elsewhere) {
        return tree(
            "p", 90000,
            [&](int i) {
                const double side = i % 3 == 0 ? 3 : 12;
                Vec3d place{dice_.between(0, side), dice_.between(0, side), noise * dice_.normal()};
                const int square = static_cast<int>(place[0]) + static_cast<int>(place[1]);
                const bool is_corner = place[0] < 3 && place[1] < 3;
                const int number = is_corner && corner == Corner::one ? 0
                                   : is_corner || !is_mixed_elsewhere ? square % 2
                                                                      : dice_.unit() < 0.5;
                place[2] += 0.008 * number;
                return Numbers{0, static_cast<std::uint16_t>(number), 0, place};
            },
            2000);
    };
    const Vec3d place{0.5, 0.5, 0};
    const auto squares = floor(Corner::squares, true);
    const StationSurvey there = station_survey(*squares, PointStations(*squares), place);
    EXPECT_TRUE(there.is_shown);
    EXPECT_FALSE(there.names_stations);
    StationsAround around(*squares, place);
    EXPECT_TRUE(around.are_named());
    // Two stations 8 mm apart are 5.7 mm each in the root of the mean square.
    const double of_two = around.spread(0);
    EXPECT_NEAR(of_two, 0.0057, 0.0025);

    const auto alone = floor(Corner::one, true);
    StationsAround of_one(*alone, place);
    EXPECT_TRUE(of_one.are_named());
    EXPECT_LT(of_one.survey().evidence().spread().freedom, 9u);
    EXPECT_NEAR(of_one.spread(0), of_two, 0.0025);
    EXPECT_GT(of_one.spread_with({}).freedom, of_one.survey().evidence().spread().freedom);

    const auto tiles = floor(Corner::squares, false);
    EXPECT_FALSE(StationsAround(*tiles, place).are_named());
    EXPECT_EQ(StationsAround(*tiles, place).spread(0.5), 0.5);
}

TEST_F(StationSurveyTest, MostOfThePlacesDecide)
{
    StationSurvey yes, no, silent;
    yes.is_shown = no.is_shown = true;
    no.names_stations = silent.names_stations = false;
    EXPECT_TRUE(name_stations({}));
    EXPECT_TRUE(name_stations({silent}));
    EXPECT_FALSE(name_stations({no, silent, silent}));
    EXPECT_TRUE(name_stations({no, yes, yes, silent}));
    EXPECT_TRUE(name_stations({no, yes, yes, no, yes}));
    EXPECT_FALSE(name_stations({no, yes, no}));
}

// The walls are eight times as rough as the floor, which alone is looked at: it shows differences of heights.
// The same squares as scans of a file that says from where they were made: stations, however little their points mix.
TEST_F(StationSurveyTest, ScansOfSeveralPlacesAreStations)
{
    Schema schema;
    schema.add({scan_attribute, ScalarType::u32, 1, 1, 0, {}});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 8000, 1, 2);
    for (std::size_t i = 0; i < cloud.points.size; ++i) {
        const auto square = [&](std::size_t a) { return static_cast<int>((cloud.points.xyz[a][i] + 2) / 0.2); };
        cloud.points.attributes[0].as<std::uint32_t>()[i] = 1 + static_cast<std::uint32_t>(square(0) + square(1)) % 2;
        cloud.points.xyz[2][i] = noise * dice_.normal();
    }
    const auto names = [&](const std::vector<std::string>& places) {
        cloud.info.metadata.clear();
        for (const std::string& place : places) {
            const std::string text =
                "9\n9\n" + place + "\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n" + place + " 1\n";
            Metadata block{"ptx.scan/" + std::to_string(cloud.info.metadata.size() + 1), {}};
            for (const char c : text) block.value.push_back(static_cast<std::byte>(c));
            cloud.info.metadata.push_back(block);
        }
        MemoryReader reader(cloud);
        BuildOptions options;
        options.overwrite = true;
        build_tree(reader, {}, folder_ / "scans.pct", options);
        const auto made = Tree::open(folder_ / "scans.pct");
        return station_survey(*made, PointStations(*made), {}).names_stations;
    };
    EXPECT_TRUE(names({"0 0 2", "3 0 2"}));
    EXPECT_FALSE(names({})) << "numbers of something";
    EXPECT_FALSE(names({"0 0 2", "0 0 2"})) << "parts of one scan";
    EXPECT_FALSE(names({"0 0 2"}));
}

TEST_F(StationSurveyTest, RoughSurfacesSayNothing)
{
    const StationSpread found = survey([&](Vec3d& place, int) {
        if (place[2] > 0.02)
            for (double& along : place) along += 0.004 * dice_.normal();
    });
    EXPECT_LT(std::fabs(found.shifts.at(9)[2] - found.shifts.at(8)[2] - shift[2]), 0.0002);
    for (const std::size_t a : {0, 1}) EXPECT_LT(std::fabs(found.shifts.at(9)[a] - found.shifts.at(8)[a]), 0.001);
}

}  // namespace
