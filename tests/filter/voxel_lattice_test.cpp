// Voxels that doubles cannot number are refused.
#include "pcm/filter/voxel_lattice.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <string>

namespace pcm {
namespace {

TEST(VoxelLattice, CountsFromTheAnchorToTheFarSideOfTheBox)
{
    const auto is_refused = [](const Vec3d& anchor, const Box3d& box) {
        try {
            check_voxels({0.01, anchor}, box, nullptr);
            return false;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("too small for coordinates"), std::string::npos) << error.what();
            return true;
        }
    };
    for (std::size_t a = 0; a < 3; ++a) {
        Box3d below{{0, 0, 0}, {1, 1, 1}}, above = below;
        below.min[a] = -1e14, above.max[a] = 1e14;  // 2^52 voxels are 4.5e13
        EXPECT_TRUE(is_refused({0, 0, 0}, below)) << a;
        EXPECT_TRUE(is_refused({0, 0, 0}, above)) << a;
        below.min[a] = -4e13, above.max[a] = 4e13;
        EXPECT_FALSE(is_refused({0, 0, 0}, below)) << a;
        EXPECT_FALSE(is_refused({0, 0, 0}, above)) << a;
    }
}

}  // namespace
}  // namespace pcm
