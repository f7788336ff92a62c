// Planes of narrow strips that the surfaces next to them turn.
#include "pcm/place/narrow_strip.h"

#include "pcm/shapes/axis_frame.h"
#include "tests/place/shape_cloud.h"

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr Vec3d strip_origin{456780, 5432100, 120};
constexpr double apart = 0.0005;  // distance of neighbours across the strip

// A strip across x, and two surfaces across its borders up to the threshold, one leading up and one down.
std::vector<std::array<double, 2>> section_of(double width, double threshold)
{
    std::vector<std::array<double, 2>> section;
    for (double x = -width / 2 + apart / 2; x < width / 2; x += apart) section.push_back({x, 0});
    for (double z = apart / 2; z < threshold; z += apart) {
        section.push_back({width / 2, z});
        section.push_back({-width / 2, -z});
    }
    return section;
}

// Slope of the line of least squares.
double slope_of(const std::vector<std::array<double, 2>>& section)
{
    double xx = 0, xz = 0;
    for (const auto& [x, z] : section) xx += x * x, xz += x * z;
    return xz / xx;
}

TEST(NarrowStrip, IsTurnedByTheSurfacesNextToItAsLeastSquaresAre)
{
    Dice dice(5);
    for (const double width : {0.06, 0.03, 0.015})
        for (const double threshold : {0.002, 0.0045}) {
            const AxisFrame frame(dice.direction());
            std::vector<Vec3d> strip;
            for (double x = -width / 2 + apart / 2; x < width / 2; x += apart)
                for (int k = -20; k <= 20; ++k) strip.push_back(strip_origin + x * frame.u + 0.05 * k * frame.v);
            EXPECT_NEAR(narrowest_spread(strip), width / std::sqrt(12.0), 0.002 * width);
            const double turn = slope_of(section_of(width, threshold));
            EXPECT_NEAR(turn_of_strip(strip, threshold), turn, 0.05 * turn) << width << " " << threshold;
        }
}

TEST(NarrowStrip, WithoutAWidthTurnsAnywhere)
{
    EXPECT_EQ(narrowest_spread({}), 0);
    EXPECT_EQ(turn_of_strip({}, 0.001), infinity);
    EXPECT_EQ(turn_of_strip({strip_origin, strip_origin}, 0.001), infinity);
}

}  // namespace
