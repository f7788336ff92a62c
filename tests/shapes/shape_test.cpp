#include "pcm/shapes/shape.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

TEST(Shapes, TheTableIsInTheOrderOfTheKinds)
{
    for (std::size_t i = 0; i < shape_kinds().size(); ++i) {
        EXPECT_EQ(static_cast<std::size_t>(shape_kinds()[i].kind), i);
        EXPECT_EQ(shape_kind(shape_kinds()[i].name), shape_kinds()[i].kind);
    }
    EXPECT_FALSE(shape_kind("cube"));
}

TEST(Shapes, TextReadsBack)
{
    for (const char* text : {"plane 1 2 3 0 0 1", "cylinder 500000.25 4800000.5 3 1 0 0 0.1", "sphere 1 2 3 0.5",
                             "cone 1 2 3 0 1 0 45", "torus 1 2 3 0 0 1 2 0.25"})
        EXPECT_EQ(text_of(parse_shape(text)), text);
    EXPECT_THROW(parse_shape("sphere 1 2 3"), Error);
    EXPECT_THROW(parse_shape("cone 0 0 0 0 0 1 90"), Error);
    EXPECT_THROW(parse_shape("torus 0 0 0 0 0 1 1 1"), Error);
    EXPECT_THROW(parse_shape("plane 0 0 0 0 0 0"), Error);
}

TEST(Shapes, DistancesAndNormals)
{
    const Shape torus = parse_shape("torus 0 0 0 0 0 2 2 0.5");
    EXPECT_DOUBLE_EQ(signed_distance(torus, {2, 0, 1}), 0.5);
    EXPECT_DOUBLE_EQ(signed_distance(torus, {0, 2, 0}), -0.5);
    const Shape cone = parse_shape("cone 0 0 0 0 0 1 45");
    EXPECT_NEAR(signed_distance(cone, {1, 0, 1}), 0, 2e-16);
    EXPECT_NEAR(signed_distance(cone, {2, 0, 0}), std::sqrt(2.0), 1e-15);
    EXPECT_DOUBLE_EQ(signed_distance(cone, {0, 0, -3}), 3);
    // A step along the normal is a step of distance.
    for (const char* text : {"plane 1 2 3 1 1 1", "cylinder 0 0 0 1 2 3 0.5", "sphere 1 2 3 0.5", "cone 1 2 3 0 1 1 30",
                             "torus 1 2 3 1 0 1 2 0.25"}) {
        const Shape shape = parse_shape(text);
        const Vec3d p{4, 5, 6.5};
        const Vec3d n = normal_at(shape, p);
        EXPECT_NEAR(length(n), 1, 1e-14) << text;
        EXPECT_NEAR(signed_distance(shape, p + 0.125 * n) - signed_distance(shape, p), 0.125, 1e-13) << text;
        EXPECT_NEAR(signed_distance(shape, p - signed_distance(shape, p) * n), 0, 1e-13) << text;
    }
}

}  // namespace
}  // namespace pcm
