// The loops that pack rows: each level of vector instructions against what their header says.

#include "pcm/build/bins/packing_loops.h"

#include "pcm/system/cpu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pcm {
namespace {

const PackingLoops& loops_of(SimdLevel level)
{
    if (level == SimdLevel::avx512) return avx512_packing_loops();
    return level == SimdLevel::avx2 ? avx2_packing_loops() : baseline_packing_loops();
}

TEST(PackingLoops, DoAtEachLevelWhatTheyPromise)
{
    std::mt19937_64 random(6);
    for (const SimdLevel level : simd_levels()) {
        SCOPED_TRACE(std::string(name_of(level)));
        const PackingLoops& loops = loops_of(level);
        for (int trial = 0; trial < 300; ++trial) {
            const int dropped = static_cast<int>(random() % 64);
            std::vector<std::uint64_t> values(1 + random() % 70), group(values.size());
            for (std::uint64_t& v : values) v = random() >> dropped;
            for (std::uint64_t& v : group) v = random();
            const std::uint64_t sign = random(), base = random(), mask = random() >> random() % 64;
            const int from = static_cast<int>(random() % 64), place = static_cast<int>(random() % 64);

            std::uint64_t differ = 0, least = mask, any = 0;
            std::vector<std::uint64_t> less, moved = group, more;
            for (const std::uint64_t v : values) {
                differ |= v ^ values[0];
                least = std::min(least, (v ^ sign) >> from & mask);
                less.push_back((v ^ sign) - base);
                any |= less.back();
                more.push_back((v + base) ^ sign);
            }
            for (std::size_t i = 0; i < values.size(); ++i) moved[i] |= (values[i] >> from & mask) << place;

            const std::size_t count = values.size();
            ASSERT_EQ(loops.differing(values.data(), count, values[0]), differ);
            ASSERT_EQ(loops.least(values.data(), count, sign, from, mask), least);
            loops.move_bits(values.data(), count, from, mask, place, group.data());
            ASSERT_EQ(group, moved);
            std::vector<std::uint64_t> changed = values;
            loops.add(changed.data(), count, base, sign);
            ASSERT_EQ(changed, more);
            ASSERT_EQ(loops.subtract(values.data(), count, sign, base), any);
            ASSERT_EQ(values, less);
        }
    }
}

}  // namespace
}  // namespace pcm
