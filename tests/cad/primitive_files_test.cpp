#include "pcm/cad/primitive_files.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"
#include "tests/cad/written_files.h"
#include "tests/support.h"

#include <algorithm>
#include <fstream>
#include <limits>

namespace pcm {
namespace {

using test::lines_of;
using test::made;
using test::text_of_file;

Primitive pipe()
{
    Primitive primitive = made("cylinder 500000.25 4800000.5 100 0 0 1 0.3", "Pipe 1");
    primitive.colour = {255, 200, 0};
    primitive.bounds.from = -1;
    primitive.bounds.to = 2;
    primitive.fit.errors = {0.001, pi / 180, 0.0002, 0};
    primitive.fit.rms = 0.0015;
    primitive.fit.inliers = 1234;
    primitive.points = 2000;
    return primitive;
}

Primitive floor_of_room()
{
    Primitive primitive = made("plane 1 2 0 0 0 1", "Floor");
    primitive.bounds.outline = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}};
    return primitive;
}

class PrimitiveFiles : public testing::Test {
protected:
    ErrorCode error_of(const char* name, const std::vector<Primitive>& primitives, const CadOptions& options = {})
    {
        try {
            write_primitives(folder_ / name, primitives, options);
        } catch (const Error& error) {
            message_ = error.what();
            EXPECT_FALSE(std::filesystem::exists(folder_ / name) && error.code() != ErrorCode::exists);
            return error.code();
        }
        ADD_FAILURE() << "accepted";
        return {};
    }
    test::TemporaryFolder folder_;
    std::string message_;
};

TEST_F(PrimitiveFiles, ATableHasUnitsInItsHeader)
{
    CadOptions options;
    options.unit = CadUnit::millimetres;
    Primitive cone = made("cone 0 0 0 0 0 1 30", "a \"b\", c");
    cone.fit.errors.radius = cone.fit.errors.position = std::numeric_limits<double>::infinity();
    write_primitives(folder_ / "a.csv", {pipe(), cone}, options);
    const auto lines = lines_of(folder_ / "a.csv");
    ASSERT_EQ(lines.size(), 3u);
    EXPECT_EQ(lines[0].rfind("name,kind,colour,x [mm],y [mm],z [mm],axis_x,axis_y,axis_z,radius [mm],tube_radius [mm],"
                             "half_angle [deg],sigma_position [mm],sigma_axis [deg],sigma_radius [mm],",
                             0),
              0u)
        << lines[0];
    EXPECT_NE(lines[0].find(",arc [deg],area [mm^2],sigma_area [mm^2],outline,"), std::string::npos);
    EXPECT_EQ(lines[1].rfind("Pipe 1,cylinder,#ffc800,500000.25,4800000.5,100,0,0,1,0.3,,,0.001,1,0.0002,,,0.0015,0,0,"
                             "1234,2000,3,,500000.25,4800000.5,99,500000.25,4800000.5,102,",
                             0),
              0u)
        << lines[1];
    EXPECT_EQ(lines[2].rfind("\"a \"\"b\"\", c\",cone,", 0), 0u) << lines[2];
    EXPECT_NE(lines[2].find(",inf,0,,,0,"), std::string::npos) << lines[2];
    write_primitives(folder_ / "b.csv", {floor_of_room()});
    EXPECT_EQ(lines_of(folder_ / "b.csv")[0].find("[m"), std::string::npos);
    EXPECT_NE(lines_of(folder_ / "b.csv")[1].find(",12,,rectangle,"), std::string::npos);  // its area, and of what
}

// By the names of the columns, of a pipe whose ends differ in all coordinates.
TEST_F(PrimitiveFiles, ATablesColumnsHoldWhatTheyAreNamedFor)
{
    Primitive tilted = pipe(), ring = made("torus 1 2 3 0 0 1 5 0.5", "ring");
    tilted.fit.shape.axis = {0.36, 0.48, 0.8};
    ring.fit.errors = {0.1, 0.2, 0.3, 0.4};
    write_primitives(folder_ / "a.csv", {tilted, ring});
    const auto lines = lines_of(folder_ / "a.csv");
    ASSERT_EQ(lines.size(), 3u);
    const auto cells_of = [](const std::string& line) {
        std::vector<std::string> cells;
        std::istringstream text(line);
        for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
        return cells;
    };
    const auto names = cells_of(lines[0]);
    const auto value = [&](const char* name, std::size_t row) {
        const auto at = std::find_if(names.begin(), names.end(), [&](const std::string& column) {
            return column == name || column.rfind(std::string(name) + " [", 0) == 0;
        });
        EXPECT_NE(at, names.end()) << name;
        return std::stod(cells_of(lines[row]).at(static_cast<std::size_t>(at - names.begin())));
    };
    const char* const ends[2][3] = {{"from_x", "from_y", "from_z"}, {"to_x", "to_y", "to_z"}};
    const char* const places[] = {"x", "y", "z"};
    const char* const axes[] = {"axis_x", "axis_y", "axis_z"};
    for (std::size_t a = 0; a < 3; ++a) {
        const double at = tilted.fit.shape.point[a], along = tilted.fit.shape.axis[a];
        EXPECT_NEAR(value(places[a], 1), at, 1e-6);
        EXPECT_NEAR(value(axes[a], 1), along, 1e-9);
        EXPECT_NEAR(value(ends[0][a], 1), at - along, 1e-6) << ends[0][a];
        EXPECT_NEAR(value(ends[1][a], 1), at + 2 * along, 1e-6) << ends[1][a];
    }
    EXPECT_EQ(value("tube_radius", 2), 0.5);
    EXPECT_EQ(value("sigma_position", 2), 0.1);
    EXPECT_EQ(value("sigma_radius", 2), 0.3);
    EXPECT_EQ(value("sigma_tube_radius", 2), 0.4);
}

TEST_F(PrimitiveFiles, ARowWithoutANameHasAllColumns)
{
    write_primitives(folder_ / "shapes.csv", {made("sphere 1 2 3 4", "")});
    const std::vector<std::string> lines = lines_of(folder_ / "shapes.csv");
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(std::count(lines[1].begin(), lines[1].end(), ','), std::count(lines[0].begin(), lines[0].end(), ','));
    EXPECT_EQ(lines[1].substr(0, 8), ",sphere,");
}

TEST_F(PrimitiveFiles, AScriptIsAsItWas)
{
    CadOptions options;
    options.unit = CadUnit::metres;
    write_primitives(folder_ / "a.scr", {pipe()}, options);
    const std::vector<std::string> expected{
        "; Primitives of a point cloud, in its own coordinates. Run it with the command SCRIPT.",
        "; Lengths are in m.",
        "; Angles are in degrees, as the drawing has them by default (AUNITS 0).",
        "_.UNDO",
        "_BE",
        "; Pipe 1",
        "_.-LAYER",
        "_M",
        "Pipe_1",
        "_C",
        "_T",
        "255,200,0",
        "Pipe_1",
        "",
        "_.UCS",
        "_W",
        "_.UCS",
        "_3",
        "_NON",
        "500000.25,4800000.5,99",
        "_NON",
        "1000001.5,4800000.5,99",
        "_NON",
        "500000.25,9600002,99",
        "_.UCS",
        "_3",
        "_NON",
        "0,0,0",
        "_NON",
        "0,-1,0",
        "_NON",
        "1,0,0",
        "_.CYLINDER",
        "_NON",
        "0,0,0",
        "0.3",
        "3",
        "_.UCS",
        "_W",
        "_.-LAYER",
        "_S",
        "0",
        "",
        "_.ZOOM",
        "_E",
        "_.UNDO",
        "_E"};
    EXPECT_EQ(lines_of(folder_ / "a.scr"), expected);
}

TEST_F(PrimitiveFiles, ScriptsMakeEachKind)
{
    Primitive cone = made("cone 1 2 3 0 0 -1 45", "cone"), tip = cone, elbow = made("torus 1 2 3 0 0 1 5 1", "elbow");
    cone.bounds.from = 0.5;
    cone.bounds.to = tip.bounds.to = 2;
    elbow.bounds.zero = {1, 0, 0};
    elbow.bounds.end = pi / 2;
    const Primitive ring = made("torus 1 2 3 0 0 1 5 1", "ring"), ball = made("sphere 1 2 3 4", "ball");
    const auto script_of = [&](const Primitive& primitive) {
        CadOptions options;
        options.overwrite = true;
        write_primitives(folder_ / "a.scr", {primitive}, options);
        std::string text;
        for (const std::string& line : lines_of(folder_ / "a.scr"))
            if (!line.empty() && line != "_NON") text += line + " ";
        const std::size_t begin = text.find("_.UCS _W _.UCS _3 ") + 18;
        return text.substr(begin, text.find(" _.UCS _W _.-LAYER", begin) - begin);
    };
    EXPECT_EQ(script_of(floor_of_room()), "0,0,0 1,0,0 0,1,0 _.3DPOLY 0,0,0 4,0,0 4,3,0 0,3,0 _C");
    EXPECT_EQ(script_of(ball), "1,2,3 3,2,3 1,5,3 _.SPHERE 0,0,0 4");
    // From the wide end towards the apex, which is above.
    EXPECT_EQ(script_of(cone).rfind("1,2,1 3,2,1 1,5,1 _.UCS _3 0,0,0 0,-1,0 1,0,0 _.CONE 0,0,0 1.99999999999999", 0),
              0u)
        << script_of(cone);
    EXPECT_NE(script_of(cone).find(" _T 0.49999999999999"), std::string::npos);
    EXPECT_EQ(script_of(tip).find(" _T "), std::string::npos);
    EXPECT_EQ(script_of(tip).substr(script_of(tip).size() - 2), " 2");
    EXPECT_EQ(script_of(ring), "1,2,3 3,2,3 1,5,3 _.UCS _3 0,0,0 0,-1,0 1,0,0 _.TORUS 0,0,0 5 1");
    // The tube's circle revolved about y, which is the axis there.
    EXPECT_EQ(script_of(elbow),
              "1,2,3 3,2,3 1,5,3 _.UCS _3 0,0,0 1,0,0 0,0,1 _.CIRCLE 5,0,0 1 _.REVOLVE _L 0,0,0 0,1,0 90");
}

TEST_F(PrimitiveFiles, NumbersOfScriptsHaveNoExponents)
{
    Primitive small = made("sphere 1e-7 -3e-20 1e22 2.5e-9", "a");
    write_primitives(folder_ / "a.scr", {small});
    const std::string text = text_of_file(folder_ / "a.scr");
    EXPECT_NE(text.find("\r\n0.0000001,-0.00000000000000000003,10000000000000000000000\r\n"), std::string::npos)
        << text;
    EXPECT_NE(text.find("\r\n0.0000000025\r\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("-0,"), std::string::npos);
}

TEST_F(PrimitiveFiles, ControlCharactersDoNotEndAComment)
{
    Primitive one = pipe();
    one.name = "a\n_.ERASE";  // a list refuses it; a program may not
    write_primitives(folder_ / "a.scr", {one});
    for (const std::string& line : lines_of(folder_ / "a.scr")) EXPECT_NE(line, "_.ERASE");
}

TEST_F(PrimitiveFiles, WhatIsLeftOutIsSaid)
{
    Primitive hidden = pipe(), no_length = pipe();
    hidden.hidden = true;
    no_length.bounds = {};
    const Primitive no_outline = made("plane 0 0 0 0 0 1", "a");
    const std::vector<Primitive> all{pipe(), hidden, no_length, no_outline, no_outline};
    const CadReport report = write_primitives(folder_ / "a.scr", all);
    EXPECT_EQ(report.written, 1u);
    EXPECT_EQ(report.notes,
              (std::vector<std::string>{"1 hidden primitive is left out", "2 planes have no outline and are left out",
                                        "1 cylinder has no known length and is left out"}));
    EXPECT_EQ(write_primitives(folder_ / "a.csv", all).written, 4u);
    EXPECT_EQ(write_primitives(folder_ / "a.json", all).written, 5u);
    EXPECT_EQ(read_primitives(folder_ / "a.json").size(), 5u);
    EXPECT_EQ(error_of("b.scr", {no_outline, hidden}), ErrorCode::invalid_argument);
    EXPECT_NE(message_.find("1 plane has no outline"), std::string::npos) << message_;
}

TEST_F(PrimitiveFiles, WhatIsRefusedWritesNothing)
{
    EXPECT_EQ(error_of("a.dwg", {pipe()}), ErrorCode::invalid_argument);
    EXPECT_NE(message_.find(".dxf, .step, .ifc, .scr"), std::string::npos) << message_;
    for (const char* name : {"a.json", "a.csv", "a.scr", "a.dxf"}) {
        EXPECT_EQ(error_of(name, {}), ErrorCode::invalid_argument) << name;
        Primitive broken = pipe();
        broken.fit.shape.radius = std::nan("");
        EXPECT_EQ(error_of(name, {broken}), ErrorCode::invalid_argument) << name;
        broken = pipe();
        broken.bounds.to = std::numeric_limits<double>::infinity();
        EXPECT_EQ(error_of(name, {broken}), ErrorCode::invalid_argument) << name;
        CadOptions options;
        options.chord = std::nan("");
        EXPECT_EQ(error_of(name, {pipe()}, options), ErrorCode::invalid_argument) << name;
    }
    std::ofstream(folder_ / "there.csv") << "mine";
    EXPECT_EQ(error_of("there.csv", {pipe()}), ErrorCode::exists);
    EXPECT_EQ(text_of_file(folder_ / "there.csv"), "mine");
    CadOptions options;
    options.overwrite = true;
    write_primitives(folder_ / "there.csv", {pipe()}, options);
    EXPECT_NE(text_of_file(folder_ / "there.csv"), "mine");
}

TEST_F(PrimitiveFiles, EveryNumberOfABoundIsFinite)
{
    for (const char* name : {"a.scr", "a.dxf"})
        for (const double number : {std::numeric_limits<double>::infinity(), std::nan("")})
            for (int which = 0; which < 7; ++which) {
                Primitive broken = pipe();
                ShapeBounds& bounds = broken.bounds;
                bounds.outline = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
                double* const numbers[] = {&bounds.from,    &bounds.to,      &bounds.begin,        &bounds.end,
                                           &bounds.zero[1], &bounds.zero[2], &bounds.outline[2][0]};
                *numbers[which] = number;
                EXPECT_EQ(error_of(name, {broken}), ErrorCode::invalid_argument) << name << ' ' << which;
                EXPECT_NE(message_.find("the bounds of '" + broken.name + "' are not finite"), std::string::npos)
                    << message_;
            }
}

TEST_F(PrimitiveFiles, ADrawingHasItsUnitLayersAndColours)
{
    if (!writes_dxf()) GTEST_SKIP() << "built without dxflib";
    CadOptions options;
    options.unit = CadUnit::feet;
    Primitive other = pipe();
    other.name = "pipe 1";
    other.colour = {0, 0, 254};
    write_primitives(folder_ / "a.dxf", {pipe(), other, floor_of_room()}, options);
    const std::string text = text_of_file(folder_ / "a.dxf");
    EXPECT_NE(text.find("$INSUNITS\n 70\n2\n"), std::string::npos);
    EXPECT_NE(text.find("$MEASUREMENT\n 70\n0\n"), std::string::npos);
    EXPECT_NE(text.find("  2\nPipe 1\n 70\n0\n 62\n40\n420\n16762880\n"), std::string::npos);
    EXPECT_NE(text.find("  2\npipe 1 (2)\n 70\n0\n 62\n5\n420\n254\n"), std::string::npos);
    EXPECT_NE(text.find("\n  8\npipe 1 (2)\n"), std::string::npos);
    EXPECT_NE(text.find("$EXTMIN\n 10\n0\n 20\n0\n"), std::string::npos);
    EXPECT_NE(text.find("$EXTMAX\n 10\n500000.55\n 20\n4800000.8\n 30\n102.3\n"), std::string::npos);
    // The view shows all of it: its centre, its height, and width by height.
    const std::string view = text.substr(text.find("AcDbViewportTableRecord"), 600);
    EXPECT_NE(view.find("\n 12\n250000.275\n 22\n2400000.4\n"), std::string::npos) << view;
    EXPECT_NE(view.find("\n 40\n5280000.88\n 41\n1.5\n"), std::string::npos) << view;
    options.unit = CadUnit::none;
    write_primitives(folder_ / "b.dxf", {pipe()}, options);
    EXPECT_EQ(text_of_file(folder_ / "b.dxf").find("$MEASUREMENT"), std::string::npos);
    // A finer chord, more faces; a part of the circle, fewer.
    const auto faces = [&](const char* name, CadOptions with) {
        with.overwrite = true;
        Primitive half = pipe();
        half.bounds.zero = {1, 0, 0};
        half.bounds.end = pi;
        write_primitives(folder_ / name, {half}, with);
        std::size_t count = 0;
        for (const std::string& line : lines_of(folder_ / name)) count += line == "3DFACE";
        return count;
    };
    const std::size_t usual = faces("c.dxf", {});
    options.chord = 1e-4;
    EXPECT_GT(faces("c.dxf", options), 2 * usual);
    options = {};
    options.arcs = true;
    EXPECT_LT(faces("c.dxf", options), usual / 2);
}

// The numbers of a drawing's points: group 10 is an x, 20 its y, 30 its z; 11, 12, 13 are those of further corners. A
// polyline itself has a point that means nothing.
Box3d box_of_entities(const std::vector<std::string>& lines, std::size_t begin)
{
    Box3d box;
    Vec3d p{};
    bool polyline = false;
    for (std::size_t i = begin; i + 1 < lines.size() && lines[i + 1] != "ENDSEC"; i += 2) {
        const int group = std::stoi(lines[i]);
        if (group == 0) polyline = lines[i + 1] == "POLYLINE";
        if (polyline || group < 10 || group > 33 || group % 10 > 3) continue;
        p[static_cast<std::size_t>(group / 10 - 1)] = std::stod(lines[i + 1]);
        if (group / 10 == 3) box.extend(p);
    }
    return box;
}

TEST_F(PrimitiveFiles, TheExtentOfADrawingHoldsAllThatIsDrawn)
{
    if (!writes_dxf()) GTEST_SKIP() << "built without dxflib";
    Primitive cone = made("cone 7 8 9 0.6 0 0.8 30", "cone"), pillar = pipe();
    cone.bounds.from = 1;
    cone.bounds.to = 5;
    for (const Primitive& one :
         {made("torus 1 2 3 0 0.6 0.8 5 1", "ring"), made("sphere -4 5 -6 3", "ball"), cone, pillar, floor_of_room()}) {
        CadOptions options;
        options.overwrite = true;
        write_primitives(folder_ / "a.dxf", {one}, options);
        const std::vector<std::string> lines = lines_of(folder_ / "a.dxf");
        const auto corner = [&](const char* name) {
            const auto at = std::find(lines.begin(), lines.end(), name);
            EXPECT_GT(lines.end() - at, 6) << name;
            if (lines.end() - at <= 6) return Vec3d{};
            return Vec3d{std::stod(at[2]), std::stod(at[4]), std::stod(at[6])};
        };
        const Vec3d low = corner("$EXTMIN"), high = corner("$EXTMAX");
        const auto entities = std::find(lines.begin(), lines.end(), "ENTITIES") - lines.begin();
        const Box3d drawn = box_of_entities(lines, static_cast<std::size_t>(entities) + 1);
        double largest = 0;
        for (std::size_t a = 0; a < 3; ++a) largest = std::max(largest, drawn.max[a] - drawn.min[a]);
        ASSERT_GT(largest, 1) << one.name;
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_LE(low[a], drawn.min[a] + 1e-9) << one.name;
            EXPECT_GE(high[a], drawn.max[a] - 1e-9) << one.name;
            EXPECT_GT(low[a], drawn.min[a] - largest) << one.name;
            EXPECT_LT(high[a], drawn.max[a] + largest) << one.name;
        }
    }
}

// Programs that ignore the axes of circles would draw those of a tilted pipe at another place.
TEST_F(PrimitiveFiles, ADrawingHasCirclesOnlyAcrossZ)
{
    if (!writes_dxf()) GTEST_SKIP() << "built without dxflib";
    const auto count = [&](const char* name, const Vec3d& axis, const char* entity) {
        Primitive one = pipe();
        one.fit.shape.axis = axis;
        CadOptions options;
        options.overwrite = true;
        write_primitives(folder_ / name, {one}, options);
        std::size_t found = 0;
        for (const std::string& line : lines_of(folder_ / name)) found += line == entity;
        return found;
    };
    EXPECT_EQ(count("a.dxf", {0, 0, 1}, "CIRCLE"), 2u);
    EXPECT_EQ(count("a.dxf", {0, 0, 1}, "POLYLINE"), 4u);
    EXPECT_EQ(count("a.dxf", {0, 0.6, 0.8}, "CIRCLE"), 0u);
    EXPECT_EQ(count("a.dxf", {0, 0.6, 0.8}, "POLYLINE"), 6u);
    EXPECT_EQ(count("a.dxf", {0, 0.6, 0.8}, "LINE"), 1u);
}

TEST_F(PrimitiveFiles, AnOutlineThatCrossesItselfIsALineAlone)
{
    if (!writes_dxf()) GTEST_SKIP() << "built without dxflib";
    Primitive plane = floor_of_room();
    std::swap(plane.bounds.outline[1], plane.bounds.outline[2]);
    const CadReport report = write_primitives(folder_ / "a.dxf", {plane});
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("'Floor' has a line and no faces"), std::string::npos);
    EXPECT_EQ(text_of_file(folder_ / "a.dxf").find("3DFACE"), std::string::npos);
    EXPECT_NE(text_of_file(folder_ / "a.dxf").find("POLYLINE"), std::string::npos);
}

TEST(CadUnits, HaveNames)
{
    for (const CadUnit unit :
         {CadUnit::none, CadUnit::metres, CadUnit::millimetres, CadUnit::centimetres, CadUnit::feet, CadUnit::inches})
        EXPECT_EQ(cad_unit(name_of(unit)), unit);
    EXPECT_FALSE(cad_unit("mile"));
}

}  // namespace
}  // namespace pcm
