// Raw scalars as unsigned words in the order of their values, so that near values have near words. Bijective.
#pragma once

#include "cloud/attribute.h"
#include "cloud/point_batch.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace pcm {

// The word that packs a scalar of type T.
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

// Calls f with a value of the C++ type that `type` names.
template <class F>
auto with_scalar(ScalarType type, F&& f)
{
    switch (type) {
    case ScalarType::i8: return f(std::int8_t());
    case ScalarType::u8: return f(std::uint8_t());
    case ScalarType::i16: return f(std::int16_t());
    case ScalarType::u16: return f(std::uint16_t());
    case ScalarType::i32: return f(std::int32_t());
    case ScalarType::u32: return f(std::uint32_t());
    case ScalarType::i64: return f(std::int64_t());
    case ScalarType::u64: return f(std::uint64_t());
    case ScalarType::f32: return f(float());
    case ScalarType::f64: break;
    }
    return f(double());
}

}  // namespace pcm
