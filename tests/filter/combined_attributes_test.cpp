#include "pcm/filter/combined_attributes.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;

TEST(CombinedAttributes, CategoriesAreKnownByTheReadersNames)
{
    for (const char* name : {"classification", "return_number", "number_of_returns", "point_source_id", "user_data",
                             "scanner_channel", "withheld", "row_index", "is_color_invalid", "scan", "source_id"})
        EXPECT_TRUE(is_categorical(name)) << name;
    for (const char* name : {"intensity", "rgb", "gps_time", "scan_angle", "scan_angle_rank", "nir", "radius"})
        EXPECT_FALSE(is_categorical(name)) << name;
    Schema schema;
    schema.add({"classification", ScalarType::f32, 1, 1, 0, {}});  // no majority of floats
    schema.add({"normal", ScalarType::f32, 3, 1, 0, {}});
    schema.add({"normal_2", ScalarType::f32, 3, 1, 0, {}});
    EXPECT_EQ(combinations_of(schema), (std::vector{Combination::mean, Combination::direction, Combination::mean}));
}

}  // namespace
