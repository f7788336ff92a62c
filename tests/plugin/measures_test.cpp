// Measures in a document's scene: what is drawn, units, moved layers, text.
#include "plugin/meshlab/document_scene.h"
#include "plugin/scene/drawn_measures.h"
#include "plugin/scene/length_unit.h"
#include "plugin/scene/measure_text.h"
#include "plugin/scene/project_unit.h"
#include "tests/plugin/met_document.h"

#include <gtest/gtest.h>

using namespace pcm;
using namespace pcm::host;

namespace {

MeasuredPoint at(double x, double y, double z)
{
    MeasuredPoint point;
    point.position = {x, y, z};
    point.grid_step = 0.01;
    return point;
}

Measure measure(MeasureKind kind, std::vector<MeasuredPoint> points)
{
    Measure made;
    made.kind = kind;
    made.name = "M";
    made.points = std::move(points);
    return made;
}

TEST(DrawnMeasures, HiddenOnesAreLeftOut)
{
    Measure a = measure(MeasureKind::distance, {at(0, 0, 0), at(3, 4, 0)}), b = a;
    b.hidden = true;
    const auto drawn = drawn_measures({a, b}, "m", std::nullopt);
    ASSERT_EQ(drawn.size(), 1u);
    EXPECT_EQ(drawn[0].line.size(), 2u);
    EXPECT_EQ(drawn[0].marks.size(), 2u);
    EXPECT_TRUE(drawn[0].label.startsWith("M\n5.")) << drawn[0].label.toStdString();
    EXPECT_TRUE(drawn[0].label.endsWith(" m"));
    EXPECT_EQ(drawn[0].label_at, (Vec3d{1.5, 2, 0}));
}

TEST(DrawnMeasures, PolygonsAreClosedAndHeightsAreUpright)
{
    const auto area =
        drawn_measures({measure(MeasureKind::area, {at(0, 0, 5), at(2, 0, 5), at(2, 2, 5), at(0, 2, 5)})}, "m", 0);
    ASSERT_EQ(area.size(), 1u);
    EXPECT_TRUE(area[0].closed);
    EXPECT_EQ(area[0].label_at, (Vec3d{1, 1, 5}));
    const auto height = drawn_measures({measure(MeasureKind::height, {at(0, 0, 1), at(2, 0, 5)})}, "m", std::nullopt);
    ASSERT_EQ(height.size(), 2u);
    EXPECT_EQ(height[0].line, (std::vector<Vec3d>{{0, 0, 1}, {0, 0, 5}}));
    EXPECT_EQ(height[1].line, (std::vector<Vec3d>{{0, 0, 5}, {2, 0, 5}}));
    const auto plane = drawn_measures(
        {measure(MeasureKind::plane, {at(0, 0, 1), at(0, 0, 0), at(1, 0, 0), at(0, 1, 0)})}, "m", std::nullopt);
    ASSERT_EQ(plane.size(), 2u);
    EXPECT_EQ(plane[1].line.size(), 3u);
    EXPECT_TRUE(plane[1].closed);
    EXPECT_EQ(plane[0].label_at, (Vec3d{0, 0, 1}));
}

TEST(MeasureText, CoordinatesHaveTheDigitsOfTheGridAndNoMore)
{
    EXPECT_EQ(coordinates_of(at(63679820 * 0.01, 84921407 * 0.01, 413.29)), "636798.2 849214.07 413.29");
    MeasuredPoint fine = at(515368.60225, 0, -1e-5);
    fine.grid_step = 0.00025;
    EXPECT_EQ(coordinates_of(fine), "515368.60225 0 -0.00001");
    fine.grid_step = 0;  // exact: all digits
    fine.position = {0.1 + 0.2, 1.0 / 3, 5};
    EXPECT_EQ(coordinates_of(fine), "0.30000000000000004 0.3333333333333333 5");
    EXPECT_EQ(value_of(measure(MeasureKind::point, {at(1.5, 2, 3)}), "m"), "1.5 2 3");
}

CoordinateSystem projected(double plan, double up)
{
    CoordinateSystem system;
    system.kind = CrsKind::projected;
    system.horizontal.unit = {"unit of x", plan};
    if (up > 0) system.vertical.unit = {"unit of z", up};
    return system;
}

TEST(LengthUnits, AreSaidWhereTheyMeanSomething)
{
    EXPECT_EQ(common_unit({}).symbol, "");
    MetDocument document;  // its clouds state none
    EXPECT_EQ(length_unit_of(scene_of(document)).symbol, "");
    choose_unit(scene_of(document), "ft");
    EXPECT_EQ(length_unit_of(scene_of(document)).symbol, "ft");
    EXPECT_FALSE(length_unit_of(scene_of(document)).is_stated);
    EXPECT_EQ(common_unit({projected(1, 0), projected(1, 1)}).symbol, "m");
    EXPECT_EQ(common_unit({projected(0.3048, 0)}).symbol, "ft");
    EXPECT_EQ(common_unit({projected(1200.0 / 3937, 0)}).symbol, "ftUS");
    EXPECT_EQ(common_unit({projected(2, 0)}).symbol, "unit of x");
    const LengthUnit mixed = common_unit({projected(0.3048, 1)});
    EXPECT_EQ(mixed.symbol, "");
    EXPECT_TRUE(mixed.warning.contains("unit of z"));
    CoordinateSystem degrees;
    degrees.kind = CrsKind::geographic;
    degrees.horizontal.unit = {"degree", 0.0174532925199433};
    EXPECT_EQ(common_unit({degrees}).symbol, "");
    EXPECT_TRUE(common_unit({degrees}).warning.contains("degrees"));
    EXPECT_TRUE(common_unit({projected(1, 0), projected(0.3048, 0)}).warning.contains("different"));
}

}  // namespace
