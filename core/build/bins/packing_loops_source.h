// Included by one source per level of system/cpu.h. No inline function of another header is used: see there.
#pragma once

#include "pcm/build/bins/packing_loops.h"

namespace pcm {

namespace {

std::uint64_t differing(const std::uint64_t* values, std::size_t count, std::uint64_t first)
{
    std::uint64_t differ = 0;
    for (std::size_t i = 0; i < count; ++i) differ |= values[i] ^ first;
    return differ;
}

std::uint64_t least(const std::uint64_t* values, std::size_t count, std::uint64_t sign, int shift, std::uint64_t mask)
{
    std::uint64_t low = mask;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t v = (values[i] ^ sign) >> shift & mask;
        low = v < low ? v : low;
    }
    return low;
}

std::uint64_t subtract(std::uint64_t* values, std::size_t count, std::uint64_t sign, std::uint64_t base)
{
    std::uint64_t any = 0;
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = (values[i] ^ sign) - base;
        any |= values[i];
    }
    return any;
}

void move_bits(const std::uint64_t* values, std::size_t count, int from, std::uint64_t mask, int place,
               std::uint64_t* to)
{
    for (std::size_t i = 0; i < count; ++i) to[i] |= (values[i] >> from & mask) << place;
}

void add(std::uint64_t* values, std::size_t count, std::uint64_t base, std::uint64_t sign)
{
    for (std::size_t i = 0; i < count; ++i) values[i] = (values[i] + base) ^ sign;
}

}  // namespace
}  // namespace pcm
