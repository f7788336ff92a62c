// Little-endian values at any place among bytes.
#pragma once

#include <cstddef>
#include <cstring>

namespace pcm {

template <class T>
T load(const std::byte* from)
{
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

}  // namespace pcm
