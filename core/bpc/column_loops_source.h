// Included by one source per level of system/cpu.h. No inline function of another header is used: see there.
#pragma once

#include "pcm/bpc/column_loops.h"

namespace pcm {

namespace {

template <class Word>
struct SignedOf;
template <>
struct SignedOf<std::uint32_t> {
    using Type = std::int32_t;
};
template <>
struct SignedOf<std::uint64_t> {
    using Type = std::int64_t;
};

template <class Word>
Word shift_down(Word d, int shift)  // arithmetic: a difference keeps its sign
{
    return static_cast<Word>(static_cast<typename SignedOf<Word>::Type>(d) >> shift);
}

template <class Word>
Word zigzag(Word d)
{
    return static_cast<Word>(d << 1) ^ shift_down(d, sizeof(Word) * 8 - 1);
}

template <class Word>
Word reference(const Word* values, std::size_t count, Word& any)
{
    Word low = values[0], bits = 0;
    for (std::size_t i = 1; i < count; ++i) low = values[i] < low ? values[i] : low;
    for (std::size_t i = 0; i < count; ++i) bits |= static_cast<Word>(values[i] - low);
    any |= bits;
    return low;
}

template <class Word>
void differences(const Word* values, std::size_t count, Word& any, Word& any_zigzag)
{
    Word bits = 0, zigzag_bits = 0;
    for (std::size_t i = 1; i < count; ++i) {
        const Word d = static_cast<Word>(values[i] - values[i - 1]);
        bits |= d;
        zigzag_bits |= zigzag(d);
    }
    any |= bits;
    any_zigzag |= zigzag_bits;
}

template <class Word>
void put_reference(const Word* values, std::size_t count, Word base, int shift, Word* to)
{
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<Word>(static_cast<Word>(values[i] - base) >> shift);
}

template <class Word>
void put_differences(const Word* values, std::size_t count, int shift, Word* to)
{
    to[0] = 0;
    for (std::size_t i = 1; i < count; ++i)
        to[i] = zigzag(shift_down(static_cast<Word>(values[i] - values[i - 1]), shift));
}

template <class Word>
constexpr ColumnLoops<Word> loops{reference<Word>, differences<Word>, put_reference<Word>, put_differences<Word>};

}  // namespace
}  // namespace pcm
