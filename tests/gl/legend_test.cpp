// Legends of what was drawn. No OpenGL.
#include "pcm/gl/draw/legend.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

TEST(Legend, HasTheRampAndTheValuesOfWhatWasDrawn)
{
    for (const ColourRamp ramp : {ColourRamp::viridis, ColourRamp::turbo, ColourRamp::grey}) {
        CloudReport report;
        report.style.colour = ColourMode::height;
        report.style.ramp = ramp;
        report.range = ValueRange{2, 10};
        const std::optional<Legend> legend = legend_of(report, "m");
        ASSERT_TRUE(legend);
        EXPECT_EQ(legend->ramp, ramp_of(report.style));
        EXPECT_EQ(legend->ramp, ramp);
        EXPECT_EQ(legend->range.low, 2);
        EXPECT_EQ(legend->range.high, 10);
        EXPECT_EQ(legend->low, value_text(2, 8));
        EXPECT_EQ(legend->middle, value_text(6, 8));
        EXPECT_EQ(legend->high, value_text(10, 8));
        EXPECT_EQ(legend->lines(),
                  (std::vector<std::string>{legend->title, legend->low, legend->middle, legend->high}));
        EXPECT_NE(legend->title.find("(m)"), std::string::npos) << legend->title;
    }
    CloudReport plain;  // without a range
    plain.style.colour = ColourMode::height;
    EXPECT_FALSE(legend_of(plain, "m"));
}

}  // namespace
}  // namespace pcm
