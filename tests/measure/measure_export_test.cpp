// Measures as CSV and GeoJSON. DXF: tests/cad and tests/independent.
#include "pcm/measure/measure_export.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <iterator>

namespace {

using namespace pcm;
using Json = nlohmann::json;

std::string text_in(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

MeasureList sample_list()
{
    MeasureList list;
    Measure line;
    line.name = "a, \"b\"";
    line.points = {{{500000.123, 4800000.456, 1.5}, 0.4, 0, ""}, {{500003.123, 4800004.456, 1.5}, 0.4, 0, ""}};
    list.add(line);
    Measure area;
    area.kind = MeasureKind::area;
    // Clockwise, seen from above.
    area.points = {{{0, 0, 0}, 0, 0, ""}, {{0, 3, 1}, 0, 0, ""}, {{4, 3, 2}, 0, 0, ""}};
    list.add(area);
    Measure wrong;
    wrong.kind = MeasureKind::angle;
    wrong.hidden = true;
    wrong.points = {{{1, 1, 1}, 0, 0, ""}, {{1, 1, 1}, 0, 0, ""}, {{2, 2, 2}, 0, 0, ""}};
    list.add(wrong);
    return list;
}

TEST(MeasureExport, CsvHasARowPerNumber)
{
    const test::TemporaryFolder folder;
    MeasureFileOptions options;
    options.system = coordinate_system_of_text("EPSG:26915", "test");
    ASSERT_TRUE(options.system);
    write_measures(sample_list(), folder / "a.csv", options);
    const std::string text = text_in(folder / "a.csv");
    EXPECT_EQ(text.find("name,kind,quantity,value,uncertainty,unit,geometry,note\r\n"), 0u);
    EXPECT_NE(text.find("\"a, \"\"b\"\"\",distance,distance,5,"), std::string::npos) << text;
    EXPECT_NE(text.find("\"LINESTRING Z (500000.123 4800000.456 1.5, 500003.123 4800004.456 1.5)\""),
              std::string::npos);
    EXPECT_NE(text.find("\"POLYGON Z ((0 0 0, 4 3 2, 0 3 1, 0 0 0))\""), std::string::npos) << text;
    EXPECT_NE(text.find("Area 1,area,plan area,6,0,"), std::string::npos) << text;
    EXPECT_NE(text.find("Angle 1,angle,,,,,"), std::string::npos) << text;
    EXPECT_NE(text.find("first point is at the place of the second"), std::string::npos) << text;
}

TEST(MeasureExport, GeoJsonIsInSourceCoordinatesAndNamesTheSystem)
{
    const test::TemporaryFolder folder;
    MeasureFileOptions options;
    options.system = coordinate_system_of_text("EPSG:26915", "test");
    write_measures(sample_list(), folder / "a.geojson", options);
    const Json json = Json::parse(text_in(folder / "a.geojson"));
    EXPECT_EQ(json["type"], "FeatureCollection");
    EXPECT_EQ(json["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::26915");
    ASSERT_EQ(json["features"].size(), 3u);
    const Json& line = json["features"][0];
    EXPECT_EQ(line["geometry"]["type"], "LineString");
    EXPECT_EQ(line["geometry"]["coordinates"][1][0], 500003.123);
    EXPECT_EQ(line["properties"]["distance"], 5);
    EXPECT_NEAR(line["properties"]["distance_uncertainty"], 0.1 * std::sqrt(2), 1e-12);
    const Json ring = json["features"][1]["geometry"]["coordinates"][0];
    ASSERT_EQ(ring.size(), 4u);
    EXPECT_EQ(ring[0], ring[3]);
    EXPECT_EQ(ring[1], Json::array({4, 3, 2}));  // counter-clockwise
    EXPECT_TRUE(json["features"][2]["properties"]["note"].is_string());
    EXPECT_EQ(json["features"][2]["properties"]["hidden"], true);
    write_measures(sample_list(), folder / "b.geojson", {});
    EXPECT_FALSE(Json::parse(text_in(folder / "b.geojson")).contains("crs"));
}

TEST(MeasureExport, NothingIsOverwrittenUnasked)
{
    const test::TemporaryFolder folder;
    for (const char* extension : measure_extensions) {
        if (std::string(extension) == ".dxf" && !writes_dxf()) continue;
        const auto file = folder / (std::string("a") + extension);
        std::ofstream(file) << "precious";
        try {
            write_measures(sample_list(), file, {});
            ADD_FAILURE() << extension;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::exists);
        }
        EXPECT_EQ(text_in(file), "precious");
        MeasureFileOptions options;
        options.overwrite = true;
        write_measures(sample_list(), file, options);
        EXPECT_NE(text_in(file), "precious");
    }
    EXPECT_THROW(write_measures(sample_list(), folder / "a.txt", {}), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
}

TEST(MeasureExport, DrawingLeavesHiddenMeasuresOut)
{
    if (!writes_dxf()) GTEST_SKIP() << "built without dxflib";
    const test::TemporaryFolder folder;
    write_measures(sample_list(), folder / "a.DXF", {});
    const std::string text = text_in(folder / "a.DXF");
    EXPECT_NE(text.find("pcm_distance"), std::string::npos);
    EXPECT_NE(text.find("pcm_area"), std::string::npos);
    EXPECT_EQ(text.find("pcm_angle"), std::string::npos);
    EXPECT_NE(text.find("\n4800004.456\n"), std::string::npos);
}

TEST(MeasureExport, UnitsOfSystems)
{
    const auto unit = [](const char* text) { return length_unit_of(coordinate_system_of_text(text, "test")); };
    EXPECT_EQ(unit(R"(PROJCS["a",GEOGCS["b",UNIT["degree",0.0174532925199433]],UNIT["metre",1]])"), "m");
    EXPECT_EQ(unit(R"(GEOGCS["b",UNIT["degree",0.0174532925199433]])"), "");
    EXPECT_EQ(length_unit_of({}), "");
}

}  // namespace
