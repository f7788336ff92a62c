#include "plugin/tools/pick/picked_text.h"

#include <gtest/gtest.h>

namespace pcm::host {
namespace {

TEST(PickedText, TheLabelHasTheDigitsThatTheSpacingAsksFor)
{
    Picked picked;
    picked.position = {500039.9999921695, -0.15310999751091003, 2.1919000148773193};
    picked.shown_at = {1, 2, 3};  // where the layer's matrix puts it: the label has the file's coordinates
    picked.spacing = 0.004;
    EXPECT_EQ(label_of(picked), "x 500039.99999\ny -0.15311\nz 2.19190");
    picked.spacing = 25;
    EXPECT_EQ(label_of(picked), "x 500040.0\ny -0.2\nz 2.2");
    picked.spacing = 0;  // not known: all digits
    EXPECT_EQ(label_of(picked), "x 500039.9999921695\ny -0.15310999751091003\nz 2.1919000148773193");
}

// 849214.4400000001 is the double of 84921444 steps of 0.01.
TEST(PickedText, TheLogHasTheDecimalsOfTheFile)
{
    Picked picked;
    picked.position = picked.shown_at = {636533.56, 849214.4400000001, 427.2};
    picked.position_text = {"636533.56", "849214.44", "427.2"};
    EXPECT_EQ(logged_text(lines_of(picked, "scan")), "636533.56 849214.44 427.2, scan");
    picked.position_text = {};  // coordinates are doubles
    EXPECT_EQ(logged_text(lines_of(picked, "scan")), "636533.56 849214.4400000001 427.2, scan");
}

}  // namespace
}  // namespace pcm::host
