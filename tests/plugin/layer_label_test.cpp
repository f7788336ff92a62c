#include "plugin/scene/layer_label.h"

#include <gtest/gtest.h>

namespace pcm::host {
namespace {

QString label(const char* present, const char* opened, std::uint64_t shown = 48947, std::uint64_t total = 20000000)
{
    return tree_label(present, opened, "/data/city.pct", shown, total);
}

TEST(LayerLabel, SaysHowManyOfThePointsAreThere)
{
    EXPECT_EQ(label("index.pct", "/data/city.pct/index.pct").toStdString(), "city (48,947 of 20,000,000)");
    EXPECT_EQ(label("city.pct", "/data/city.pct").toStdString(), "city (48,947 of 20,000,000)");
    EXPECT_EQ(label("", "/data/city.pct").toStdString(), "city (48,947 of 20,000,000)");
    EXPECT_EQ(label("city.pct", "/data/city.pct", 500, 500).toStdString(), "city");
}

TEST(LayerLabel, NamesTheFileThatTheTreeWasBuiltOf)
{
    const auto of = [](const char* opened, const char* tree) {
        return tree_label("scan.las", opened, tree, 10, 2000).toStdString();
    };
    EXPECT_EQ(of("/data/scan.las", "/data/scan.pct"), "scan (10 of 2,000)");
    EXPECT_EQ(of("/data/scan.las", "/trees/scan-0123abcd.pct"), "scan (10 of 2,000)");
}

TEST(LayerLabel, FollowsTheTreeWhenItIsChangedOrReopened)
{
    EXPECT_EQ(label("city (48,947 of 20,000,000)", "/data/city.pct", 40000, 9000000).toStdString(),
              "city (40,000 of 9,000,000)");
    EXPECT_EQ(label("city (48,947 of 20,000,000)", "/data/city.pct/index.pct", 7, 7).toStdString(), "city");
    // MeshLab has numbered the second of two layers of one name.
    EXPECT_EQ(label("city (1)", "/data/city.pct").toStdString(), "city (48,947 of 20,000,000)");
    EXPECT_EQ(label("index(2).pct", "/data/city.pct/index.pct").toStdString(), "city (48,947 of 20,000,000)");
}

TEST(LayerLabel, KeepsTheNameThatAUserGave)
{
    EXPECT_EQ(label("roof", "/data/city.pct").toStdString(), "roof");
    EXPECT_EQ(label("city north", "/data/city.pct").toStdString(), "city north");
    EXPECT_EQ(label("roof (48,947 of 20,000,000)", "/data/city.pct", 5, 900).toStdString(), "roof (5 of 900)");
}

}  // namespace
}  // namespace pcm::host
