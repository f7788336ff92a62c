#include "pcm/shapes/primitive_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace pcm {
namespace {

ShapeFit fit_of(const char* shape, double position, double angle)
{
    ShapeFit fit;
    fit.shape = parse_shape(shape);
    fit.errors.position = position;
    fit.errors.angle = angle;
    return fit;
}

TEST(PlaceText, HasTheDigitsThatAreKnown)
{
    EXPECT_EQ(place_text(fit_of("cylinder 500040.00000812 4800019.99997669 96.00149549 0 0 1 2.95", 3e-5, 2e-5)),
              "cylinder through 500040.000008 4800019.999977 96.001495, axis 0 0 1.000000");
    EXPECT_EQ(place_text(fit_of("plane 1.23456 2 3 0 0 -1", 0.02, 0)),
              "plane through 1.235 2.000 3.000, normal 0 0 -1");
    EXPECT_EQ(place_text(fit_of("sphere 1.25 2 3 4", 0, 0)), "sphere about 1.25 2 3");
    EXPECT_EQ(place_text(fit_of("cone 0 0 9 0 0 -1 30", std::numeric_limits<double>::infinity(), 0)),
              "cone with its apex at 0 0 9.00000, axis 0 0 -1");
    EXPECT_EQ(place_text(fit_of("torus 1 2 3 0 0 1 4 0.5", 0, 0)), "torus about 1 2 3, axis 0 0 1");
}

}  // namespace
}  // namespace pcm
