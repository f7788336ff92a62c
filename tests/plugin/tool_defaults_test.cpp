// Numbers that tools propose, and their digits.
#include "plugin/scene/tidy_numbers.h"
#include "plugin/tools/measure/default_width.h"

#include "pcm/system/text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pcm::host {
namespace {

TEST(DefaultWidth, FromTheLineThePictureAndTheMedianOfTheSpacings)
{
    // A roof of a drone's cloud, points 1.25 m apart, across 14.5 m: not the 12.5 m of ten spacings.
    EXPECT_EQ(default_width({14.5, 0.02, {1.254138708114624, 1.1}}), 2);
    EXPECT_EQ(default_width({500, 0.5, {1.254, 1.1}}), 10);
    // One click next to the surface, where points are far apart, does not decide.
    EXPECT_EQ(default_width({100, 0.001, {0.05, 9, 0.06}}), 0.5);
    EXPECT_EQ(default_width({100, 0.5, {0.01}}), 2);       // no narrower than three pixels
    EXPECT_EQ(default_width({15.8, 1.5, {0.7, 0.7}}), 2);  // three pixels are a third of this line
    EXPECT_EQ(default_width({2, 0.001, {1, 1}}), 2);       // nor than two spacings
    EXPECT_EQ(default_width({100, 0.001, {0, 0}}), 2);     // spacings that are not known
    EXPECT_EQ(default_width({100, 0, {}}), 2);
    EXPECT_EQ(default_width({0, 0, {}}), 0);
    EXPECT_EQ(default_width({1e-4, 1e-7, {1e-6}}), 1e-5);
}

TEST(TidyNumbers, HaveTheDigitsOfTheStep)
{
    EXPECT_EQ(decimal(12.54138708114624, 0.001), 12.541);
    EXPECT_EQ(decimal(636500.2549999999, 0.01), 636500.25);
    EXPECT_EQ(decimal(-3.5, 0.01), -3.5);
    EXPECT_EQ(decimal(1.23456, 0.025), 1.235);
    EXPECT_EQ(decimal(1234.4, 10), 1234);  // no fewer digits than the integer has
    EXPECT_EQ(decimal(12.54138708114624, 0), 12.54138708114624);
    EXPECT_EQ(decimal(12.54138708114624, 1e-20), 12.54138708114624);
    EXPECT_TRUE(std::isnan(decimal(std::nan(""), 0.1)));
    EXPECT_EQ(decimal_text(684962.0600000001, 0.001), "684962.06");
}

TEST(TidyNumbers, ABoxStillContainsWhatItWasMadeAround)
{
    const Box3d bounds{{684962.0604, 9598131.8801, 11.0702}, {686156.8599, 9599506.0904, 155.3207}};
    ClipBox box;
    for (std::size_t a = 0; a < 3; ++a) {
        box.centre[a] = (bounds.min[a] + bounds.max[a]) / 2;
        box.half[a] = (bounds.max[a] - bounds.min[a]) / 2;
    }
    box.outside = true;
    const ClipBox tidy = tidied(box, 0.001, true);
    EXPECT_TRUE(tidy.outside);
    for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_LE(tidy.centre[a] - tidy.half[a], bounds.min[a]);
        EXPECT_GE(tidy.centre[a] + tidy.half[a], bounds.max[a]);
        EXPECT_LT(tidy.half[a] - box.half[a], 0.0021);
        EXPECT_LE(exact(tidy.centre[a]).size(), 12u) << exact(tidy.centre[a]);
        EXPECT_LE(exact(2 * tidy.half[a]).size(), 8u) << exact(2 * tidy.half[a]);
    }
    const ClipBox dragged = tidied(box, 0.01);
    EXPECT_NEAR(dragged.half[0], box.half[0], 0.0025 + 1e-9);
    // A flat cloud keeps its size.
    box.half[2] = 1e-6;
    EXPECT_EQ(tidied(box, 0.01).half[2], 1e-6);
    EXPECT_EQ(tidied(box, 0).half[0], box.half[0]);
}

}  // namespace
}  // namespace pcm::host
