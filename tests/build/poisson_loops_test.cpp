// The loops of a Poisson pass: each level of vector instructions against plain ones.

#include "pcm/build/levels/poisson_loops.h"

#include "pcm/system/cpu.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

namespace pcm {
namespace {

const PoissonLoops& poisson_loops_of(SimdLevel level)
{
    if (level == SimdLevel::avx512) return avx512_poisson_loops();
    return level == SimdLevel::avx2 ? avx2_poisson_loops() : baseline_poisson_loops();
}

struct ChosenList {
    std::vector<float> x, y, z;
    std::size_t count = 0;
    void add(float px, float py, float pz)
    {
        for (std::vector<float>* axis : {&x, &y, &z}) axis->resize(count);
        x.push_back(px);
        y.push_back(py);
        z.push_back(pz);
        ++count;
        for (std::vector<float>* axis : {&x, &y, &z}) axis->resize(count + near_padding, 1e18f);
    }
    ChosenNear near() const { return {x.data(), y.data(), z.data(), count}; }
};

TEST(PoissonLoops, FindTheFirstOpenPointAtEveryLevel)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(0, 4);
    constexpr std::size_t points = 300, mask = 0xffe;
    constexpr std::uint16_t cells = 40;
    auto placed = std::make_unique<PlacedPoints>();
    for (std::size_t i = 0; i < points; ++i) {
        placed->x[i] = place(random);
        placed->y[i] = place(random);
        placed->z[i] = place(random);
        placed->cell[i] = static_cast<std::uint16_t>(i * cells / points);
    }
    std::vector<std::uint64_t> taken(1, 0);
    for (std::size_t cell = 0; cell < cells; cell += 3) taken[0] |= std::uint64_t(1) << cell;
    for (std::size_t many = 0; many <= 40; ++many) {  // none, fewer and more than a vector holds
        ChosenList chosen;
        for (std::size_t n = 0; n < many; ++n) chosen.add(place(random), place(random), place(random));
        for (std::size_t from = 0; from < points; ++from) {
            const std::size_t bucket = placed->cell[from] & mask;
            OpenPoint expected{points, false};
            for (std::size_t i = from; i < points && expected.index == points; ++i) {
                if (taken[0] >> placed->cell[i] & 1) continue;
                bool inside = false, perhaps = false;
                for (std::size_t n = 0; n < many; ++n) {
                    const float dx = chosen.x[n] - placed->x[i], dy = chosen.y[n] - placed->y[i],
                                dz = chosen.z[n] - placed->z[i];
                    const float squared = dx * dx + dy * dy + dz * dz;
                    inside = inside || squared < surely_inside;
                    perhaps = perhaps || squared < surely_outside;
                }
                const bool elsewhere = (placed->cell[i] & mask) != bucket;
                if (elsewhere || !inside) expected = {i, !elsewhere && !perhaps};
            }
            for (const SimdLevel level : simd_levels()) {
                const OpenPoint found = poisson_loops_of(level).first_open(*placed, from, points, taken.data(), bucket,
                                                                           mask, chosen.near());
                ASSERT_EQ(found.index, expected.index) << name_of(level) << ", " << many << " chosen, from " << from;
                ASSERT_EQ(found.is_sure, expected.is_sure) << name_of(level);
            }
        }
    }
}

// A point is open and not sure where float cannot show on which side of the spacing it lies.
TEST(PoissonLoops, APointAtTheSpacingIsNotSure)
{
    auto placed = std::make_unique<PlacedPoints>();
    placed->x[0] = placed->y[0] = placed->z[0] = 0;
    placed->cell[0] = 0;
    const std::uint64_t taken = 0;
    for (const SimdLevel level : simd_levels())
        for (const std::size_t before : {0, 3, 15, 16, 20}) {
            ChosenList chosen;
            for (std::size_t n = 0; n < before; ++n) chosen.add(3, 3, 3);
            const auto open_at = [&](float distance) {
                ChosenList with = chosen;
                with.add(distance, 0, 0);
                return poisson_loops_of(level).first_open(*placed, 0, 1, &taken, 0, 0, with.near());
            };
            EXPECT_EQ(open_at(1 - 1e-4f).index, 1u) << name_of(level) << " " << before;
            for (const float distance : {1 - 1e-6f, 1.0f, 1 + 1e-6f}) {
                EXPECT_EQ(open_at(distance).index, 0u) << name_of(level) << " " << before;
                EXPECT_FALSE(open_at(distance).is_sure) << name_of(level) << " " << before;
            }
            EXPECT_EQ(open_at(1 + 1e-4f).index, 0u);
            EXPECT_TRUE(open_at(1 + 1e-4f).is_sure) << name_of(level) << " " << before;
        }
}

}  // namespace
}  // namespace pcm
