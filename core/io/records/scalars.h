// Copies scalars of records into columns of a batch: any type, any stride, either byte order.
#pragma once

#include "pcm/cloud/with_type.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pcm {

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

// The same for scalars of `bytes` bytes; with Swap, each is byte-swapped as one number.
template <bool Swap = false>
void copy_scalars(std::size_t bytes, const std::byte* from, std::size_t stride, std::size_t count, std::byte* to,
                  std::size_t to_stride)
{
    switch (bytes) {
        case 1:
            return copy_scalars<1, Swap>(from, stride, count, to, to_stride);
        case 2:
            return copy_scalars<2, Swap>(from, stride, count, to, to_stride);
        case 4:
            return copy_scalars<4, Swap>(from, stride, count, to, to_stride);
        case 8:
            return copy_scalars<8, Swap>(from, stride, count, to, to_stride);
        default:
            for (std::size_t i = 0; i < count; ++i)
                for (std::size_t b = 0; b < bytes; ++b)
                    to[i * to_stride + b] = from[i * stride + (Swap ? bytes - 1 - b : b)];
    }
}

}  // namespace pcm
