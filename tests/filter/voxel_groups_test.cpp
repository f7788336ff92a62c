// Groups of points by voxel against a map, with numbers of voxels of all sizes.
#include "pcm/filter/voxel_groups.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>

namespace {

using namespace pcm;

// Points in few voxels of a box that has 2^x, 2^y and 2^z of them along its sides, its corners among them.
Positions points_in(std::array<unsigned, 3> bits, std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::vector<std::array<std::int64_t, 3>> voxels;
    for (std::size_t i = 0; i < 40; ++i) {
        std::array<std::int64_t, 3> voxel{};
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t side = std::uint64_t(1) << bits[a];
            const std::uint64_t corners[] = {0, side - 1, side / 2, random() % side};
            voxel[a] = static_cast<std::int64_t>(corners[i < 2 ? i : random() % 4] - side / 3);
        }
        voxels.push_back(voxel);
    }
    Positions points;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& voxel = voxels[i < 2 ? i : random() % voxels.size()];
        Vec3d p;
        for (std::size_t a = 0; a < 3; ++a) p[a] = static_cast<double>(voxel[a]) + 0.25 * double(random() % 4);
        points.push_back(p);
    }
    return points;
}

void expect_groups_of_a_map(const Positions& points)
{
    const VoxelLattice lattice;
    std::map<std::array<std::int64_t, 3>, std::vector<std::uint32_t>> voxels;  // key: z, y, x
    for (std::uint32_t i = 0; i < points.size(); ++i)
        voxels[{lattice.index(points[i][2], 2), lattice.index(points[i][1], 1), lattice.index(points[i][0], 0)}]
            .push_back(i);
    VoxelSort scratch;
    PointGroups groups;
    group_by_voxel(points, lattice, scratch, groups);
    ASSERT_EQ(groups.size(), voxels.size());
    std::size_t g = 0;
    for (const auto& [voxel, expected] : voxels) {
        const std::vector<std::uint32_t> found(groups.order.begin() + groups.begins[g],
                                               groups.order.begin() + groups.begins[g + 1]);
        ASSERT_EQ(found, expected) << "voxel " << voxel[2] << " " << voxel[1] << " " << voxel[0];
        ++g;
    }
}

// Numbers of voxels and of points together fit 64 bits, or do not: 256 points take 8 bits, 257 take 9.
TEST(VoxelGroups, AreThoseOfAMapForNumbersOfMoreThan64Bits)
{
    using Bits = std::array<unsigned, 3>;
    for (const Bits& bits :
         {Bits{0, 0, 0}, Bits{3, 2, 1}, Bits{20, 18, 17}, Bits{20, 18, 18}, Bits{19, 19, 19}, Bits{50, 3, 3},
          Bits{3, 50, 3}, Bits{3, 3, 50}, Bits{51, 3, 3}, Bits{3, 51, 3}, Bits{0, 0, 51}, Bits{5, 51, 0},
          Bits{0, 25, 32}, Bits{21, 21, 22}, Bits{40, 40, 40}, Bits{51, 51, 51}})
        for (const std::size_t count : {1u, 2u, 256u, 257u, 1000u}) {
            SCOPED_TRACE(std::to_string(bits[0]) + " " + std::to_string(bits[1]) + " " + std::to_string(bits[2]) +
                         " bits, " + std::to_string(count) + " points");
            expect_groups_of_a_map(points_in(bits, count, count));
            if (testing::Test::HasFatalFailure()) return;
        }
}

}  // namespace
