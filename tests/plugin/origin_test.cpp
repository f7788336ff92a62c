#include "plugin/scene/origin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pcm::host {
namespace {

TEST(Origin, IsZeroWhereFloatDoesNotMind)
{
    EXPECT_EQ(choose_origin({{-3, 2, 0}, {40, 50, 10}}), (Vec3d{0, 0, 0}));
    EXPECT_EQ(choose_origin({{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}}), (Vec3d{0, 0, 0}));
    const Box3d map{{500000.25, 4800000.5, 90}, {500101, 4800102, 121}};
    EXPECT_EQ(choose_origin(map), (Vec3d{500051, 4800051, 106}));
}

TEST(Origin, BoundsTheRoundingOfFloat)
{
    const Box3d boxes[] = {{{500000.1, 4800000.7, 90.3}, {500123.4, 4800099.9, 121.7}},
                           {{-3.1, 2.7, 0}, {40.3, 50.1, 10.9}},
                           {{1e6 + 1e-6, 1e6, 1e6}, {1e6 + 3e-6, 1e6 + 2e-6, 1e6 + 1e-6}},
                           {{7, 8, 9}, {7, 8, 9}}};
    for (const Box3d& box : boxes) {
        const Vec3d origin = choose_origin(box);
        double largest = 0;
        for (int i = 0; i <= 1000; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                const double local = box.min[a] + box.extent(a) * i / 1000 - origin[a];
                largest = std::max(largest, std::fabs(static_cast<double>(static_cast<float>(local)) - local));
            }
        EXPECT_LE(largest, float_rounding(box, origin));
        // No more than eight times what the best origin would give.
        EXPECT_LE(float_rounding(box, origin), 8 * std::ldexp(box.diagonal(), -24));
    }
}

}  // namespace
}  // namespace pcm::host
