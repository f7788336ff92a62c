// Measures as texts.
#include "pcm/measure/measure.h"

#include <gtest/gtest.h>

#include <string>

namespace {

using namespace pcm;

TEST(MeasureText, ValuesHaveTheDigitsThatTheirUncertaintyLeaves)
{
    const auto text = [](double value, double uncertainty, const char* unit, const char* length) {
        return text_of({"", value, uncertainty, unit}, length);
    };
    EXPECT_EQ(text(12.34567, 0.0023, "", "m"), "12.346 ± 0.002 m");
    EXPECT_EQ(text(12.34567, 0.00149, "", "m"), "12.3457 ± 0.0015 m");
    EXPECT_EQ(text(12.34567, 0.00999, "", ""), "12.346 ± 0.010");
    EXPECT_EQ(text(1234567, 2345, "^3", "m"), "1235000 ± 2000 m³");
    EXPECT_EQ(text(-12.5, 0, "^2", "ft"), "-12.5 ft²");
    EXPECT_EQ(text(44.96, 0.3, "deg", "m"), "45.0 ± 0.3°");
    EXPECT_EQ(text(3.2, 0, "%", "m"), "3.2 %");
    EXPECT_EQ(text(3.2, 0, "^2", ""), "3.2");
}

TEST(MeasureText, LabelsAreTheFirstValueOrWhatIsMissing)
{
    Measure distance;
    distance.kind = MeasureKind::distance;
    distance.points = {{{0, 0, 0}, 0, 0, ""}};
    EXPECT_NE(label_of(distance, "m").find("takes 2"), std::string::npos);
    distance.points.push_back({{3, 4, 0}, 0, 0, ""});
    EXPECT_EQ(label_of(distance, "m"), "5 m");
}

}  // namespace
