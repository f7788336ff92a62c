#include "plugin/meshlab/filter/numbers.h"

#include "plugin/meshlab/plugin_bases.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pcm::host {
namespace {

std::vector<double> list(const QVariant& value)
{
    const auto numbers = value.value<Eigen::VectorXd>();
    return {numbers.data(), numbers.data() + numbers.size()};
}

TEST(Numbers, ThoseOfAnAnswerHaveTheNamesOfItsMembers)
{
    const auto numbers =
        numbers_of(ops::Json::parse(R"({"command": "fit", "points": 7, "bytes": 5000000000, "seconds": 0.5,
        "good": true, "output": null, "notes": [], "shape": {"radius": 2.5, "centre": [1, 2, 3.5]}, "levels": [1, 20, 300, 4000]})"));
    EXPECT_EQ(numbers.count("command") + numbers.count("output"), 0u);
    EXPECT_EQ(numbers.at("points").userType(), QMetaType::Int);
    EXPECT_EQ(numbers.at("points").toInt(), 7);
    EXPECT_EQ(numbers.at("bytes").userType(), QMetaType::Double);
    EXPECT_EQ(numbers.at("bytes").toDouble(), 5e9);
    EXPECT_EQ(numbers.at("seconds").toDouble(), 0.5);
    EXPECT_TRUE(numbers.at("good").toBool());
    EXPECT_EQ(numbers.at("notes_count").toInt(), 0);
    EXPECT_EQ(numbers.at("shape_radius").toDouble(), 2.5);
    EXPECT_EQ(list(numbers.at("shape_centre")), (std::vector<double>{1, 2, 3.5}));
    EXPECT_EQ(list(numbers.at("levels")), (std::vector<double>{1, 20, 300, 4000}));
}

TEST(Numbers, AListOfObjectsIsAListForEachMember)
{
    const auto numbers =
        numbers_of(ops::Json::parse(R"({"primitives": [{"name": "Plane 1", "point": [1, 2, 3], "rms": 0.1},
        {"name": "Sphere 1", "point": [4, 5, 6], "rms": 0.2, "radius": 7}]})"));
    EXPECT_EQ(numbers.at("primitives_count").toInt(), 2);
    EXPECT_EQ(list(numbers.at("primitives_rms")), (std::vector<double>{0.1, 0.2}));
    EXPECT_EQ(list(numbers.at("primitives_point_y")), (std::vector<double>{2, 5}));
    EXPECT_TRUE(std::isnan(list(numbers.at("primitives_radius"))[0]));
    EXPECT_EQ(list(numbers.at("primitives_radius"))[1], 7);
    EXPECT_EQ(numbers.count("primitives_name"), 0u);
}

}  // namespace
}  // namespace pcm::host
