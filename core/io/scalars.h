// Scalars of records as columns of a batch: of any type, at any distance from each other, in either byte order.
#pragma once

#include "cloud/attribute.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pcm {

// Calls `f` with a value of the C++ type that `type` names.
template <class F>
auto with_type(ScalarType type, F&& f)
{
    switch (type) {
        case ScalarType::i8:
            return f(std::int8_t{});
        case ScalarType::u8:
            return f(std::uint8_t{});
        case ScalarType::i16:
            return f(std::int16_t{});
        case ScalarType::u16:
            return f(std::uint16_t{});
        case ScalarType::i32:
            return f(std::int32_t{});
        case ScalarType::u32:
            return f(std::uint32_t{});
        case ScalarType::i64:
            return f(std::int64_t{});
        case ScalarType::u64:
            return f(std::uint64_t{});
        case ScalarType::f32:
            return f(float{});
        case ScalarType::f64:
            break;
    }
    return f(double{});
}

template <std::size_t Bytes, bool Swap>
void load_bytes(const std::byte* from, std::byte* to)
{
    if constexpr (Swap) {
        for (std::size_t i = 0; i < Bytes; ++i) to[i] = from[Bytes - 1 - i];
    } else {
        std::memcpy(to, from, Bytes);
    }
}

template <class T, bool Swap = false>
T load_scalar(const std::byte* from)
{
    T value;
    load_bytes<sizeof(T), Swap>(from, reinterpret_cast<std::byte*>(&value));
    return value;
}

// One scalar of each of `count` records, `stride` bytes apart.
template <class T, bool Swap = false>
void widen(const std::byte* from, std::size_t stride, std::size_t count, double* to)
{
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<double>(load_scalar<T, Swap>(from + i * stride));
}

template <std::size_t Bytes, bool Swap = false>
void copy_scalars(const std::byte* from, std::size_t stride, std::size_t count, std::byte* to, std::size_t to_stride)
{
    for (std::size_t i = 0; i < count; ++i) load_bytes<Bytes, Swap>(from + i * stride, to + i * to_stride);
}

}  // namespace pcm
