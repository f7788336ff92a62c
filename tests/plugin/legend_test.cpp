#include "plugin/overlay/legend.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/crs/height_unit.h"
#include "plugin/overlay/legend_edit.h"
#include "plugin/settings/colour_settings.h"
#include "tests/scene/fake_settings.h"

#include <gtest/gtest.h>

#include <cstring>

using namespace pcm;
using namespace pcm::host;

namespace {

std::vector<Metadata> crs(const std::string& text)
{
    Metadata block{crs_comment, {}};
    block.value.resize(text.size());
    std::memcpy(block.value.data(), text.data(), text.size());
    return {block};
}

CloudReport values(ColourMode mode, double low, double high)
{
    CloudReport report;
    report.style.colour = mode;
    report.range = ValueRange{low, high, 1};
    return report;
}

std::string text_of(const std::optional<Legend>& legend)
{
    if (!legend) return "none";
    std::string text;
    for (const std::string& line : legend->lines()) text += (text.empty() ? "" : " | ") + line;
    return text;
}

}  // namespace

TEST(Legend, NamesValuesAndUnits)
{
    EXPECT_EQ(text_of(legend_of(values(ColourMode::height, 398.75, 450.26), "source units")),
              "Height (source units) | 398.8 | 424.5 | 450.3");
    const char* const feet =
        R"(PROJCS["a",GEOGCS["b",DATUM["c",SPHEROID["d",6378137,298.25]],PRIMEM["e",0],UNIT["degree",0.0174532925199433]],)"
        R"(PROJECTION["Transverse_Mercator"],UNIT["foot",0.3048]])";
    EXPECT_EQ(height_unit(crs(feet)), "ft");
    EXPECT_EQ(height_unit({}), "source units");
    EXPECT_EQ(text_of(legend_of(values(ColourMode::intensity, 0, 255), "source units")), "Intensity | 0 | 128 | 255");
    CloudReport report = values(ColourMode::attribute, 0.001, 0.002);
    report.style.attribute = "gps_time";
    EXPECT_EQ(text_of(legend_of(report, "source units")), "gps_time (s) | 0.001 | 0.0015 | 0.002");
    // The middle is what the ramp's middle shows.
    report.range->exponent = 0.5;
    EXPECT_EQ(text_of(legend_of(report, "source units")), "gps_time (s) | 0.001 | 0.00125 | 0.002");
    for (const ColourMode mode : {ColourMode::rgb, ColourMode::uniform, ColourMode::level})
        EXPECT_EQ(text_of(legend_of(values(mode, 0, 1), "source units")), "none");
    EXPECT_EQ(text_of(legend_of(values(ColourMode::classification, 0, 1), "source units")),
              "none");  // nothing was drawn yet
}

TEST(Legend, OnlyClassesThatOccurAndThoseThatAreHidden)
{
    CloudReport report;
    report.style.colour = ColourMode::classification;
    report.classes.set(2);
    report.classes.set(6);
    report.classes.set(200);
    const auto legend = legend_of(report, "m", {9});
    EXPECT_EQ(text_of(legend), "Classification | 2  ground | 6  building | 9  water (hidden) | 200  user defined");
    EXPECT_EQ(legend->rows[0].colour, class_colour(2));
}

TEST(Legend, ValuesHaveTheDigitsThatTheirRangeNeeds)
{
    EXPECT_EQ(value_text(4800012.3456, 100), "4800012");
    EXPECT_EQ(value_text(4800012.3456, 5), "4800012.35");
    EXPECT_EQ(value_text(0.5, 1), "0.5");
    EXPECT_EQ(value_text(-0.0000001, 1), "0");
    EXPECT_EQ(value_text(1e15, 1e15), "1e+15");
    EXPECT_EQ(value_text(2.5e-9, 1e-9), "2.5e-09");
}

TEST(Legend, ItsPictureHasTheRampAndPlacesOfClasses)
{
    std::vector<LayerLegend> legends;
    CloudReport report = values(ColourMode::height, 0, 10);
    add_legend(legends, *legend_of(report, "source units"), "a");
    add_legend(legends, *legend_of(report, "source units"), "b");  // the same
    ASSERT_EQ(legends.size(), 1u);
    EXPECT_EQ(legends[0].layers, (QStringList{"a", "b"}));
    LegendPicture picture = draw_legends(legends, 1000, 1);
    ASSERT_FALSE(picture.image.isNull());
    EXPECT_TRUE(picture.classes.empty());
    const auto has = [&](const std::array<float, 3>& colour) {
        for (int y = 0; y < picture.image.height(); ++y) {
            const QColor c = picture.image.pixelColor(16, y);
            if (std::abs(c.red() - 255 * colour[0]) < 2 && std::abs(c.green() - 255 * colour[1]) < 2 &&
                std::abs(c.blue() - 255 * colour[2]) < 2)
                return true;
        }
        return false;
    };
    for (const float t : {0.0f, 0.5f, 1.0f}) EXPECT_TRUE(has(ramp_colour(t))) << t;
    EXPECT_EQ(draw_legends(legends, 1000, 2).image.width(), 2 * picture.image.width());

    report = {};
    report.style.colour = ColourMode::classification;
    report.classes.set(2);
    report.classes.set(5);
    add_legend(legends, *legend_of(report, "source units"), "c");
    picture = draw_legends(legends, 1000, 1);
    ASSERT_EQ(picture.classes.size(), 2u);
    EXPECT_EQ(picture.classes[1].second, 5u);
    EXPECT_TRUE(picture.image.rect().contains(picture.classes[1].first));
    EXPECT_FALSE(picture.classes[0].first.intersects(picture.classes[1].first));
    // What does not fit is left out, but for the first.
    EXPECT_EQ(draw_legends(legends, 10, 1).image.height(), draw_legends({legends[0]}, 1000, 1).image.height());
    EXPECT_TRUE(draw_legends({}, 1000, 1).image.isNull());
}

TEST(Legend, ItsBarIsWhereTheRampIsAndKnowsItsValues)
{
    std::vector<LayerLegend> legends;
    add_legend(legends, *legend_of(values(ColourMode::height, 400, 450), "m"), "a");
    const LegendPicture picture = draw_legends(legends, 1000, 1);
    ASSERT_EQ(picture.bars.size(), 1u);
    const LegendPicture::Bar& bar = picture.bars[0];
    EXPECT_EQ(bar.range, (ValueRange{400, 450, 1}));
    const auto colour_at = [&](int y) { return picture.image.pixelColor(bar.place.left() + 2, y); };
    const auto top = ramp_colour(1), bottom = ramp_colour(0);
    EXPECT_NEAR(colour_at(bar.place.top()).redF(), double(top[0]), 0.02);
    EXPECT_NEAR(colour_at(bar.place.bottom()).greenF(), double(bottom[1]), 0.02);
    EXPECT_NE(colour_at(bar.place.top() - 1), colour_at(bar.place.top()));
}

// Heights in the bar: 0 at its top.
TEST(Legend, DraggingAnEndSetsIt)
{
    const ValueRange range{400, 450, 1};
    EXPECT_EQ(dragged_range(range, 0, 0.2), (ValueRange{400, 440, 1}));
    EXPECT_EQ(dragged_range(range, 0.1, 0.3), (ValueRange{400, 440, 1}));  // wherever the upper half is taken
    EXPECT_EQ(dragged_range(range, 1, 0.9), (ValueRange{405, 450, 1}));
    EXPECT_EQ(dragged_range(range, 0.6, 0.5), (ValueRange{405, 450, 1}));
    EXPECT_EQ(dragged_range(range, 0, -1), (ValueRange{400, 500, 1}));  // beyond the bar
    EXPECT_EQ(dragged_range(range, 1, 2), (ValueRange{350, 450, 1}));
    EXPECT_EQ(dragged_range(range, 0, 3), (ValueRange{400, 400.5, 1}));  // the ends do not meet
    EXPECT_EQ(dragged_range(range, 1, -3), (ValueRange{449.5, 450, 1}));
    EXPECT_EQ(dragged_range(range, 0, 1.0 / 3), (ValueRange{400, 433.3, 1}));  // rounded
    EXPECT_NEAR(dragged_range({0, 1000, 0.5}, 0, 0.5).high, 250, 1);           // a bent ramp
}

TEST(ColourSettings, AreReadAndWrongOnesReported)
{
    const auto kept = std::make_shared<Parameters>();
    Parameters& parameters = *kept;
    add_colour_settings(parameters);
    CloudStyle style;
    ColourSettings settings = read_colour_settings(parameters, style);
    CloudStyle untouched;
    untouched.uniform_colour = style.uniform_colour;  // rounded to 8 bits
    EXPECT_EQ(style, untouched);
    EXPECT_TRUE(settings.legend);
    EXPECT_EQ(settings.problem, "");

    const auto set = [&](const char* name, const QString& text) {
        parameters.set(QString("MeshLab::PointCloud::") + name, text);
    };
    set("Attribute", " gps_time ");
    set("Range", "-1 : 2.5");
    set("Conditions", "classification=2,6; z>3 ;");
    set("HiddenClasses", "18 7,7");
    parameters.set("MeshLab::PointCloud::Ramp", 3);
    settings = read_colour_settings(parameters, style);
    EXPECT_EQ(style.attribute, "gps_time");
    EXPECT_EQ(*style.range, (ValueRange{-1, 2.5, 1}));
    EXPECT_EQ(style.ramp, ColourRamp::turbo);
    ASSERT_EQ(style.where.size(), 3u);
    EXPECT_EQ(style.where[1].text, "z>3");
    EXPECT_EQ(style.where[2].text, "classification!=7,18");
    EXPECT_EQ(settings.hidden_classes, (std::set<unsigned>{7, 18}));
    EXPECT_EQ(settings.problem, "");

    FakeSettings store(kept);
    toggle_class(store, 7);
    toggle_class(store, 3);
    style = {};
    EXPECT_EQ(read_colour_settings(parameters, style).hidden_classes, (std::set<unsigned>{3, 18}));

    set("Range", "5:1");
    set("Conditions", "z>3; what");
    set("HiddenClasses", "7, 300, x");
    style = {};
    settings = read_colour_settings(parameters, style);
    EXPECT_FALSE(style.range);
    EXPECT_EQ(style.where.size(), 2u);
    EXPECT_EQ(settings.hidden_classes, (std::set<unsigned>{7}));
    for (const char* part : {"'5:1'", "'what'", "'300'", "'x'"}) EXPECT_TRUE(settings.problem.contains(part)) << part;
}
