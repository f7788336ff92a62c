// DXF files, read back by a parser of their group codes.
#include "pcm/cad/dxf_file.h"

#include "pcm/cad/dxf_text.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace pcm;

struct Entity {
    std::string type;
    std::multimap<int, std::string> groups;
    std::string text(int code) const
    {
        const auto found = groups.find(code);
        return found == groups.end() ? "" : found->second;
    }
    double number(int code) const { return std::strtod(text(code).c_str(), nullptr); }
    Vec3d at(int code) const { return {number(code), number(code + 10), number(code + 20)}; }
};

// The entities of the section ENTITIES, or the records of another one.
std::vector<Entity> section(const std::filesystem::path& path, const std::string& name)
{
    std::ifstream file(path);
    std::vector<Entity> found;
    std::string code, value, inside;
    bool starts = false;
    while (std::getline(file, code) && std::getline(file, value)) {
        const int number = std::stoi(code);
        if (number == 0 && value == "SECTION") {
            starts = true;
        } else if (number == 2 && starts) {
            inside = value;
            starts = false;
        } else if (number == 0 && value == "ENDSEC") {
            inside.clear();
        } else if (inside == name) {
            if (number == 0)
                found.push_back({value, {}});
            else if (!found.empty())
                found.back().groups.emplace(number, value);
        }
    }
    return found;
}

class Dxf : public testing::Test {
protected:
    void SetUp() override
    {
        if (!writes_dxf()) GTEST_SKIP() << "built without dxflib";
    }
    test::TemporaryFolder folder_;
};

// By the subclass markers, group 100, programs know what the groups behind them mean.
TEST_F(Dxf, EntitiesHaveTheMarkersAndGroupsOfTheFormat)
{
    {
        DxfFile file(folder_ / "a.dxf", {{"L"}});
        file.point("L", {1, 2, 3});
        file.line("L", {1, 2, 3}, {4, 5, 6});
        file.polyline("L", {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, true);
        file.polyline("L", {{1, 2, 3}, {4, 5, 6}}, false);
        file.face("L", {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12});
        file.circle("L", {1, 2, 3}, {0, 0, 1}, 4);
        file.text("L", {1, 2, 3}, 0.5, "words");
        file.finish();
    }
    std::string found;
    for (const Entity& entity : section(folder_ / "a.dxf", "ENTITIES")) {
        found += entity.type + ":";
        for (const auto& [code, value] : entity.groups) {
            if (code == 5) continue;  // its handle
            char* end = nullptr;
            const double number = std::strtod(value.c_str(), &end);
            std::ostringstream text;
            code == 100 || code == 8 || end == value.c_str() ? text << value : text << number;
            found += " " + std::to_string(code) + "=" + text.str();
        }
        found += "\n";
    }
    const std::string vertex = "VERTEX: 8=L ",
                      markers = " 70=32 100=AcDbEntity 100=AcDbVertex 100=AcDb3dPolylineVertex\n";
    const std::string one = vertex + "10=1 20=2 30=3" + markers, two = vertex + "10=4 20=5 30=6" + markers,
                      three = vertex + "10=7 20=8 30=9" + markers, end = "SEQEND: 8=L 100=AcDbEntity\n";
    const auto polyline = [](int flags) {
        return "POLYLINE: 8=L 10=0 20=0 30=0 66=1 70=" + std::to_string(flags) + " 100=AcDbEntity 100=AcDb3dPolyline\n";
    };
    EXPECT_EQ(found,
              "POINT: 8=L 10=1 20=2 30=3 100=AcDbEntity 100=AcDbPoint\n"
              "LINE: 8=L 10=1 11=4 20=2 21=5 30=3 31=6 100=AcDbEntity 100=AcDbLine\n" +
                  polyline(9) + one + two + three + end + polyline(8) + one + two + end +
                  "3DFACE: 8=L 10=1 11=4 12=7 13=10 20=2 21=5 22=8 23=11 30=3 31=6 32=9 33=12 100=AcDbEntity "
                  "100=AcDbFace\n"
                  "CIRCLE: 8=L 10=1 20=2 30=3 40=4 100=AcDbEntity 100=AcDbCircle 210=0 220=0 230=1\n"
                  "TEXT: 1=words 8=L 10=1 20=2 30=3 40=0.5 100=AcDbEntity 100=AcDbText 100=AcDbText\n");
}

TEST_F(Dxf, CirclesAreInTheAxesOfTheirNormals)
{
    DxfFile file(folder_ / "a.dxf", {{"a", 1}});
    file.circle("a", {1, 2, 3}, {0, 0, 1}, 4);
    file.circle("a", {1, 2, 3}, {1, 0, 0}, 4);
    file.circle("a", {1, 2, 3}, {0, 0, -1}, 4);
    file.face("a", {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 5});
    file.finish();
    const std::vector<Entity> entities = section(folder_ / "a.dxf", "ENTITIES");
    ASSERT_EQ(entities.size(), 4u);
    EXPECT_EQ(entities[0].at(10), (Vec3d{1, 2, 3}));
    EXPECT_EQ(entities[0].number(40), 4);
    // A normal along x: the axes are y and z.
    EXPECT_EQ(entities[1].at(10), (Vec3d{2, 3, 1}));
    EXPECT_EQ(entities[1].number(210), 1);
    // Downwards: x is turned around.
    EXPECT_EQ(entities[2].at(10), (Vec3d{-1, 2, -3}));
    EXPECT_EQ(entities[2].type, "CIRCLE");
    EXPECT_EQ(entities[3].type, "3DFACE");
    EXPECT_EQ(entities[3].at(13), (Vec3d{0, 1, 5}));
}

TEST_F(Dxf, CirclesThatAreNoneAreRefused)
{
    DxfFile file(folder_ / "a.dxf", {{"a", 1}});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(file.circle("a", {1, 2, 3}, {0, 0, 0}, 4), Error);
    EXPECT_THROW(file.circle("a", {1, 2, 3}, {0, nan, 1}, 4), Error);
    EXPECT_THROW(file.circle("a", {1, nan, 3}, {0, 0, 1}, 4), Error);
    EXPECT_THROW(file.circle("a", {1, 2, 3}, {0, 0, 1}, 0), Error);
    EXPECT_THROW(file.circle("a", {1, 2, 3}, {0, 0, 1}, nan), Error);
    EXPECT_THROW(file.face("a", {1, 2, 3}, {0, 0, nan}, {}, {}), Error);
    EXPECT_THROW(file.circle("b", {1, 2, 3}, {0, 0, 1}, 4), Error);
    file.finish();
    EXPECT_TRUE(section(folder_ / "a.dxf", "ENTITIES").empty());
}

TEST_F(Dxf, CoordinatesReadBackAsTheSameDoubles)
{
    const std::vector<Vec3d> points{{500000.123456789, 4800000.987654321, -0.1},
                                    {1.0 / 3, -2.0 / 3, 1e-6 / 3},
                                    {1e9 + 1.0 / 1024, -1e9 / 7, 123456789.123456789},
                                    {0, -0.0, 5e-324},
                                    {1e300, -1e-300, 1e22}};
    DxfFile file(folder_ / "a.dxf", {{"scan", 1}});
    for (const Vec3d& p : points) file.point("scan", p);
    file.line("scan", points[0], points[1]);
    file.polyline("scan", points, true);
    file.polyline("scan", points, false);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.dxf"));  // not before it is complete
    file.finish();
    const std::vector<Entity> entities = section(folder_ / "a.dxf", "ENTITIES");
    ASSERT_EQ(entities.size(), points.size() + 1 + 2 * (points.size() + 2));
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(entities[i].type, "POINT");
        EXPECT_EQ(entities[i].text(8), "scan");
        EXPECT_EQ(entities[i].at(10), points[i]);
    }
    const Entity& line = entities[points.size()];
    EXPECT_EQ(line.type, "LINE");
    EXPECT_EQ(line.at(10), points[0]);
    EXPECT_EQ(line.at(11), points[1]);
    for (const bool closed : {true, false}) {
        const std::size_t begin = points.size() + 1 + (closed ? 0 : points.size() + 2);
        EXPECT_EQ(entities[begin].type, "POLYLINE");
        EXPECT_EQ(std::stoi(entities[begin].text(70)), closed ? 9 : 8);
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_EQ(entities[begin + 1 + i].type, "VERTEX");
            EXPECT_EQ(entities[begin + 1 + i].at(10), points[i]);
            EXPECT_EQ(std::stoi(entities[begin + 1 + i].text(70)), 32);
        }
        EXPECT_EQ(entities[begin + points.size() + 1].type, "SEQEND");
    }
}

TEST_F(Dxf, HandlesAreNeverUsedTwice)
{
    DxfFile file(folder_ / "a.dxf", {{"a", 1}, {"b", 2}});
    for (int i = 0; i < 300; ++i) file.point("a", {1.0 * i, 2, 3});
    file.finish();
    std::map<std::string, int> seen;
    for (const char* name : {"TABLES", "BLOCKS", "ENTITIES", "OBJECTS"})
        for (const Entity& entity : section(folder_ / "a.dxf", name))
            if (const std::string handle = entity.text(5); !handle.empty() && entity.type != "DIMSTYLE") ++seen[handle];
    EXPECT_GT(seen.size(), 300u);
    for (const auto& [handle, times] : seen) EXPECT_EQ(times, 1) << handle;
}

// Programs number what they add from there on.
TEST_F(Dxf, TheSeedOfHandlesIsAboveAllOfThem)
{
    for (const int points : {1, 70000}) {
        DxfFile file(folder_ / "a.dxf", {{"a", 1}});
        for (int i = 0; i < points; ++i) file.point("a", {1.0 * i, 2, 3});
        file.finish();
        unsigned long largest = 0;
        for (const char* name : {"TABLES", "BLOCKS", "ENTITIES", "OBJECTS"})
            for (const Entity& entity : section(folder_ / "a.dxf", name))
                largest = std::max(largest, std::strtoul(entity.text(5).c_str(), nullptr, 16));
        EXPECT_GT(largest, static_cast<unsigned long>(points));
        std::ifstream text(folder_ / "a.dxf");
        std::string line;
        while (std::getline(text, line) && line != "$HANDSEED") continue;
        std::getline(text, line);
        EXPECT_EQ(line, "  5");
        std::getline(text, line);
        const unsigned long seed = std::strtoul(line.c_str(), nullptr, 16);
        EXPECT_GT(seed, largest) << points;
        EXPECT_LE(seed, largest + 100) << points;
    }
}

// The dictionary that lists an object is its owner: the one at the beginning has none.
TEST_F(Dxf, ObjectsNameTheirOwners)
{
    DxfFile file(folder_ / "a.dxf", {{"a", 1}});
    file.point("a", {1, 2, 3});
    file.finish();
    std::map<std::string, std::string> listed;
    std::size_t owned = 0;
    for (const Entity& object : section(folder_ / "a.dxf", "OBJECTS")) {
        ASSERT_EQ(object.groups.count(5), 1u) << object.type;
        ASSERT_GE(object.groups.count(330), 1u) << object.type;
        const std::string handle = object.text(5), owner = object.groups.lower_bound(330)->second;
        EXPECT_EQ(owner, listed.count(handle) ? listed[handle] : "0") << object.type << " " << handle;
        owned += owner != "0";
        const auto [first, last] = object.groups.equal_range(350);
        for (auto entry = first; entry != last; ++entry) listed[entry->second] = handle;
    }
    EXPECT_EQ(owned, listed.size());
    EXPECT_GE(owned, 13u);
}

TEST_F(Dxf, LayersAreInTheTable)
{
    DxfFile file(folder_ / "a.dxf", {{"ground/north", 3}, {"b", 5}, {"b", 6}});
    file.point("ground/north", {1, 2, 3});
    EXPECT_THROW(file.point("c", {1, 2, 3}), Error);
    file.finish();
    std::map<std::string, int> colours;
    for (const Entity& entity : section(folder_ / "a.dxf", "TABLES"))
        if (entity.type == "LAYER") colours[entity.text(2)] = std::stoi(entity.text(62));
    EXPECT_EQ(colours, (std::map<std::string, int>{{"0", 7}, {"ground_north", 3}, {"b", 5}}));
    EXPECT_EQ(section(folder_ / "a.dxf", "ENTITIES")[0].text(8), "ground_north");
}

TEST_F(Dxf, TextIsAscii)
{
    DxfFile file(folder_ / "a.dxf", {{"a", 1}});
    file.text("a", {1, 2, 3}, 0.25, "5 \u00b1 2 m\u00b2, 50 %\n\U0001F600 ^");
    EXPECT_THROW(file.text("a", {1, 2, 3}, 0, "x"), Error);
    file.finish();
    const Entity text = section(folder_ / "a.dxf", "ENTITIES").at(0);
    EXPECT_EQ(text.text(1), "5 \\U+00B1 2 m\\U+00B2, 50 %%% \\U+D83D\\U+DE00 ^ ");
    EXPECT_EQ(std::stod(text.text(40)), 0.25);
    EXPECT_EQ(text.at(10), (Vec3d{1, 2, 3}));
    EXPECT_EQ(dxf_text("a\xff\xc3"), "a??");
    EXPECT_EQ(dxf_layer_name(""), "0");
    EXPECT_EQ(dxf_layer_name("a|b`c"), "a_b_c");
}

TEST_F(Dxf, WrongNumbersAreRefused)
{
    DxfFile file(folder_ / "a.dxf", {{"a", 1}});
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    EXPECT_THROW(file.point("a", {nan, 0, 0}), Error);
    EXPECT_THROW(file.line("a", {0, 0, 0}, {0, infinity, 0}), Error);
    EXPECT_THROW(file.polyline("a", {{0, 0, 0}, {0, 0, nan}}, false), Error);
    EXPECT_THROW(file.polyline("a", {{0, 0, 0}}, false), Error);
    EXPECT_THROW(file.text("a", {0, 0, nan}, 1, "x"), Error);
    EXPECT_THROW(file.text("a", {0, 0, 0}, nan, "x"), Error);
}

TEST_F(Dxf, FaultsOfTheDiskAreErrors)
{
    EXPECT_THROW(DxfFile(folder_ / "none" / "a.dxf", {}), Error);
    {
        DxfFile unfinished(folder_ / "a.dxf", {{"a", 1}});
        unfinished.point("a", {1, 2, 3});
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST(DxfMissing, IsAClearError)
{
    if (writes_dxf()) GTEST_SKIP() << "built with dxflib";
    try {
        DxfFile file("a.dxf", {});
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
    }
}

}  // namespace
