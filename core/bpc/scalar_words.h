// Bijection between raw scalars and unsigned words that preserves the order of the values, so that near values have
// near words.
#pragma once

#include "pcm/cloud/attribute.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace pcm {

// The type of a scalar's word.
template <class T>
using WordOf = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;

inline std::uint64_t word_bytes_of(ScalarType type) { return size_of(type) == 8 ? 8 : 4; }

template <std::size_t bytes>
using BitsOf = std::conditional_t<
    bytes == 1, std::uint8_t,
    std::conditional_t<bytes == 2, std::uint16_t, std::conditional_t<bytes == 4, std::uint32_t, std::uint64_t>>>;

template <class T>
WordOf<T> to_word(T value)
{
    using Bits = BitsOf<sizeof(T)>;
    Bits bits;
    std::memcpy(&bits, &value, sizeof(T));
    constexpr Bits sign = static_cast<Bits>(Bits(1) << (sizeof(T) * 8 - 1));
    if constexpr (std::is_floating_point_v<T>)
        bits = static_cast<Bits>(bits & sign ? static_cast<Bits>(~bits) : static_cast<Bits>(bits | sign));
    else if constexpr (std::is_signed_v<T>)
        bits = static_cast<Bits>(bits ^ sign);
    return static_cast<WordOf<T>>(bits);
}

template <class T>
T from_word(WordOf<T> word)
{
    using Bits = BitsOf<sizeof(T)>;
    auto bits = static_cast<Bits>(word);
    constexpr Bits sign = static_cast<Bits>(Bits(1) << (sizeof(T) * 8 - 1));
    if constexpr (std::is_floating_point_v<T>)
        bits = static_cast<Bits>(bits & sign ? static_cast<Bits>(bits ^ sign) : static_cast<Bits>(~bits));
    else if constexpr (std::is_signed_v<T>)
        bits = static_cast<Bits>(bits ^ sign);
    T value;
    std::memcpy(&value, &bits, sizeof(T));
    return value;
}

}  // namespace pcm
