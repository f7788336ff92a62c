// Which shapes of a list count as the same as a new one.
#include "plugin/tools/fit/same_shape.h"

#include "pcm/shapes/shape.h"

#include <gtest/gtest.h>

namespace pcm::host {
namespace {

Primitive cylinder(const std::string& shape, double from, double to, const std::string& cloud = "a.pct")
{
    Primitive made;
    made.cloud = cloud;
    made.fit.shape = parse_shape("cylinder " + shape);
    made.fit.threshold = 0.05;
    made.bounds.from = from;
    made.bounds.to = to;
    return made;
}

TEST(SameShape, TheSameSurfaceAndExtent)
{
    PrimitiveList list;
    list.add(cylinder("500100 4800000 100 0 0 1 2", 0, 10));
    list.add(cylinder("500000 4800000 100 0 0 1 2", 0, 10));
    const auto same = [&](const Primitive& primitive) { return same_shape(list, primitive); };
    EXPECT_EQ(same(cylinder("500000 4800000 100 0 0 1 2", 0, 10)), 1u);
    // Fitted again from another place: a little off, another start of the axis and its other direction.
    EXPECT_EQ(same(cylinder("500000.01 4800000 105 0 0 1 2.01", -5, 5.5)), 1u);
    EXPECT_EQ(same(cylinder("500000 4800000 100 0 0 -1 2", -10, 0)), 1u);
    EXPECT_EQ(same(cylinder("500100 4800000 100 0 0 1 2", 0, 10)), 0u);
    EXPECT_FALSE(same(cylinder("500000 4800000 100 0 0 1 2.2", 0, 10)));         // another radius
    EXPECT_FALSE(same(cylinder("500000.3 4800000 100 0 0 1 2", 0, 10)));         // another place
    EXPECT_FALSE(same(cylinder("500000 4800000 100 0 0 1 2", 20, 30)));          // the same pipe, another piece
    EXPECT_FALSE(same(cylinder("500000 4800000 100 0 0 1 2", 0, 3)));            // a third of it
    EXPECT_FALSE(same(cylinder("500000 4800000 100 0 0 1 2", 0, 10, "b.pct")));  // another cloud
    Primitive sphere = cylinder("500000 4800000 100 0 0 1 2", 0, 10);
    sphere.fit.shape = parse_shape("sphere 500000 4800000 105 2");
    EXPECT_FALSE(same(sphere));
    EXPECT_FALSE(same_shape(PrimitiveList(), cylinder("500000 4800000 100 0 0 1 2", 0, 10)));
}

}  // namespace
}  // namespace pcm::host
