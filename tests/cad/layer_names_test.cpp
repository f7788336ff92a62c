#include "pcm/cad/layer_names.h"

#include "pcm/cad/colours.h"
#include "pcm/cad/dxf_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pcm {
namespace {

using Names = std::vector<std::string>;

TEST(LayerNames, AreAllDifferentAndAllowed)
{
    EXPECT_EQ(
        layer_names({"Wall", "wall", "WALL", "Wall (2)", "a<>/\\\":;?*|,=`b", "  x ", " ", "0", "defpoints"}),
        (Names{"Wall", "wall (2)", "WALL (3)", "Wall (2) (2)", "a_____________b", "x", "_", "0 (2)", "defpoints (2)"}));
    EXPECT_EQ(layer_names({"R\u00f6hre", "R\u00f6hre"}), (Names{"R\u00f6hre", "R\u00f6hre (2)"}));
}

TEST(LayerNames, AreNotTooLong)
{
    for (const std::string& letter : {std::string("a"), std::string("\u00e4"), std::string("\U0001f600")}) {
        std::string name;
        while (name.size() < 990) name += letter;
        const Names names = layer_names({name, name, name});
        for (const std::string& one : names) {
            EXPECT_LE(dxf_layer_name(one).size(), 255u);
            EXPECT_GT(dxf_layer_name(one).size(), 235u);
            EXPECT_EQ(dxf_layer_name(one).find('?'), std::string::npos) << "a character was cut in two";
        }
        EXPECT_NE(names[0], names[1]);
        EXPECT_NE(names[1], names[2]);
    }
}

TEST(LayerNames, ManyOfOneName)
{
    const Names names = layer_names(Names(30000, "Cylinder"));
    EXPECT_EQ(names.back(), "Cylinder (30000)");
}

TEST(LayerNames, ThatAreTypedHaveNoBlanks)
{
    EXPECT_EQ(plain_layer_names({"Cylinder 1", "cylinder_1", "R\u00f6hre \u2265 5", "\U0001f600", "a;b", "0"}),
              (Names{"Cylinder_1", "cylinder_1_2", "Roehre___5", "_", "a_b", "0_2"}));
}

TEST(LayerNames, ThatAreTypedKeepWhatOtherScriptsSay)
{
    EXPECT_EQ(plain_layer_names({"\u0422\u0440\u0443\u0431\u0430 3", "\u03a3\u03c9\u03bb\u03ae\u03bd\u03b1\u03c2",
                                 "\u4e2d\u6587", "\u4e2d\u56fd", "\u0141\u00f3d\u017a \u00c9tage \u00d7 2", "\u042a"}),
              (Names{"Truba_3", "Solinas", "U4E2DU6587", "U4E2DU56FD", "Lodz_Etage___2", "_"}));
    EXPECT_EQ(plain_layer_names({"a\xff\xe4z"})[0], "a__z") << "not UTF-8";
    EXPECT_EQ(plain_layer_names({"\xe4\xb8"})[0], "__") << "the end is cut off";
}

TEST(Colours, OfTheIndexAreTheirOwnNearest)
{
    EXPECT_EQ(indexed_colour(1), (Rgb{255, 0, 0}));
    EXPECT_EQ(indexed_colour(8), (Rgb{128, 128, 128}));
    EXPECT_EQ(indexed_colour(9), (Rgb{192, 192, 192}));
    const int greys[] = {51, 80, 105, 130, 190, 255};
    for (int i = 0; i < 6; ++i) {
        const auto grey = static_cast<std::uint8_t>(greys[i]);
        EXPECT_EQ(indexed_colour(250 + i), (Rgb{grey, grey, grey}));
    }
    EXPECT_EQ(indexed_colour(30), (Rgb{255, 127, 0}));
    EXPECT_EQ(indexed_colour(12), (Rgb{165, 0, 0}));
    EXPECT_EQ(indexed_colour(94), (Rgb{0, 127, 0}));
    EXPECT_EQ(indexed_colour(176), (Rgb{0, 0, 76}));
    EXPECT_EQ(indexed_colour(18), (Rgb{38, 0, 0}));
    EXPECT_EQ(indexed_colour(173), (Rgb{82, 82, 165}));
    for (int i = 1; i <= 255; ++i)
        EXPECT_EQ(indexed_colour(nearest_colour_index(indexed_colour(i))), indexed_colour(i));
    EXPECT_EQ(nearest_colour_index({254, 1, 1}), 1);
    EXPECT_EQ(nearest_colour_index({255, 200, 0}), 40);
}

}  // namespace
}  // namespace pcm
