// Rounding to floats. Built optimised (tests/CMakeLists.txt), as a compiler's fault is what is looked for.
#include "pcm/cloud/nearest_float.h"

#include "pcm/cloud/geometry.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;

// Not inlined: with constant arguments the compiler would compute the result itself, without the fault.
[[gnu::noinline]] Vec3d rounded(const Vec3d& point, bool single) { return single ? nearest_float(point) : point; }

[[gnu::noinline]] Box3d rounded(const Box3d& around, bool single)
{
    Box3d box = around;
    if (single)
        for (std::size_t a = 0; a < 3; ++a) {
            box.min[a] = nearest_float(box.min[a]);
            box.max[a] = nearest_float(box.max[a]);
        }
    return box;
}

TEST(NearestFloat, RoundsEveryCoordinate)
{
    const double third = 1.0 / 3, expected = 0.3333333432674407958984375;  // 11184811 / 2^25
    const Vec3d thirds{third, third, third}, floats{expected, expected, expected};
    EXPECT_EQ(rounded(thirds, true), floats);
    EXPECT_EQ(rounded(thirds, false), thirds);
    EXPECT_EQ(rounded(Box3d{thirds, thirds}, true), (Box3d{floats, floats}));
}

}  // namespace
