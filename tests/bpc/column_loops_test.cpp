// The loops that pack columns: each level of vector instructions against what their header says.

#include "pcm/bpc/column_loops.h"

#include "pcm/system/cpu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <type_traits>
#include <vector>

namespace pcm {
namespace {

const AllColumnLoops& loops_of(SimdLevel level)
{
    if (level == SimdLevel::avx512) return avx512_column_loops();
    return level == SimdLevel::avx2 ? avx2_column_loops() : baseline_column_loops();
}

template <class Word>
Word zigzag(Word d)
{
    return static_cast<Word>(d << 1) ^ (d >> (sizeof(Word) * 8 - 1) ? static_cast<Word>(~Word(0)) : Word(0));
}

template <class Word>
void check(const ColumnLoops<Word>& loops)
{
    using Signed = std::make_signed_t<Word>;
    constexpr int bits = sizeof(Word) * 8;
    std::mt19937_64 random(7);
    for (int trial = 0; trial < 300; ++trial) {
        const int dropped = static_cast<int>(random() % bits), shift = static_cast<int>(random() % bits);
        std::vector<Word> values(1 + random() % 140);
        for (Word& v : values) v = static_cast<Word>(static_cast<Word>(random()) >> dropped);
        const std::size_t count = values.size();

        const Word low = *std::min_element(values.begin(), values.end());
        Word any = 3, any_difference = 5, any_zigzag = 9;  // bits are added
        std::vector<Word> from_low, steps{0};
        for (const Word v : values) {
            any |= static_cast<Word>(v - low);
            from_low.push_back(static_cast<Word>(static_cast<Word>(v - low) >> shift));
        }
        for (std::size_t i = 1; i < count; ++i) {
            const Word d = static_cast<Word>(values[i] - values[i - 1]);
            any_difference |= d;
            any_zigzag |= zigzag(d);
            steps.push_back(zigzag(static_cast<Word>(static_cast<Signed>(d) >> shift)));
        }

        Word found = 3, found_difference = 5, found_zigzag = 9;
        ASSERT_EQ(loops.reference(values.data(), count, found), low);
        ASSERT_EQ(found, any);
        loops.differences(values.data(), count, found_difference, found_zigzag);
        ASSERT_EQ(found_difference, any_difference);
        ASSERT_EQ(found_zigzag, any_zigzag);
        std::vector<Word> to(count, 1);
        loops.put_reference(values.data(), count, low, shift, to.data());
        ASSERT_EQ(to, from_low);
        to.assign(count, 1);
        loops.put_differences(values.data(), count, shift, to.data());
        ASSERT_EQ(to, steps);
    }
}

TEST(ColumnLoops, DoAtEachLevelWhatTheyPromise)
{
    for (const SimdLevel level : simd_levels()) {
        SCOPED_TRACE(std::string(name_of(level)));
        check(loops_of(level).narrow);
        check(loops_of(level).wide);
    }
}

}  // namespace
}  // namespace pcm
