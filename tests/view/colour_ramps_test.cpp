#include "pcm/view/colour_ramps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

using namespace pcm;

namespace {

// CIE L*, from 0 to 100, of an sRGB colour.
double lightness(const std::array<float, 3>& colour)
{
    const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
    const double y = 0.2126 * linear(static_cast<double>(colour[0])) + 0.7152 * linear(static_cast<double>(colour[1])) +
                     0.0722 * linear(static_cast<double>(colour[2]));
    return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

}  // namespace

TEST(ColourRamps, RowsAreInTheOrderOfTheEnumeratorsAndNamesAreUnique)
{
    std::set<std::string> names, labels;
    for (std::size_t i = 0; i < colour_ramps().size(); ++i) {
        const RampTraits& row = colour_ramps()[i];
        EXPECT_EQ(static_cast<std::size_t>(row.ramp), i) << row.name;
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_TRUE(labels.insert(row.label).second) << row.label;
        EXPECT_STRNE(row.description, "") << row.name;
    }
    EXPECT_EQ(static_cast<int>(ColourRamp::diverging), 4);  // MeshLab stores the number
}

TEST(ColourRamps, AreClampedAndContinuous)
{
    for (const RampTraits& row : colour_ramps()) {
        EXPECT_EQ(ramp_colour(-1, row.ramp), row.table.front());
        EXPECT_EQ(ramp_colour(2, row.ramp), row.table.back());
        for (float t = 0; t < 1; t += 0.001f)
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(ramp_colour(t, row.ramp)[c], ramp_colour(t + 0.001f, row.ramp)[c], 0.008) << row.name;
                EXPECT_GE(ramp_colour(t, row.ramp)[c], 0);
                EXPECT_LE(ramp_colour(t, row.ramp)[c], 1);
            }
    }
}

TEST(ColourRamps, LightnessIsAsEvenAsTheTableSays)
{
    for (const RampTraits& row : colour_ramps()) {
        const double first = lightness(row.table.front()), last = lightness(row.table.back());
        double farthest = 0;
        for (float t = 0; t <= 1; t += 0.01f) {
            const double even = first + static_cast<double>(t) * (last - first);
            farthest = std::max(farthest, std::fabs(lightness(ramp_colour(t, row.ramp)) - even));
        }
        EXPECT_EQ(farthest <= 6, row.is_even) << row.name << " " << farthest;
        if (row.is_even) EXPECT_GT(last - first, 70) << row.name;
    }
}
