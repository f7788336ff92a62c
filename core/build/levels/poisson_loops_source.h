// Included by one source per level of system/cpu.h. No inline function of another header is used: see there.
#pragma once

#include "pcm/build/levels/poisson_loops.h"
#include "pcm/system/vector_bytes.h"

namespace pcm {

namespace {

constexpr std::size_t width = vector_bytes / sizeof(float);
static_assert(near_padding % width == 0);

using Lanes = float __attribute__((vector_size(vector_bytes)));
using Flags = std::int32_t __attribute__((vector_size(vector_bytes)));

Lanes lanes_at(const float* from)
{
    Lanes v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}

bool any(Flags flags)
{
#if defined(__AVX512F__) && defined(__clang__)
    using Half = std::int32_t __attribute__((vector_size(32)));
    using HalfLanes = float __attribute__((vector_size(32)));
    Half halves[2];
    __builtin_memcpy(halves, &flags, sizeof flags);
    return __builtin_ia32_movmskps256(reinterpret_cast<HalfLanes>(halves[0] | halves[1])) != 0;
#elif defined(__AVX512F__)
    using Bits = long long __attribute__((vector_size(64)));
    return __builtin_ia32_ptestmq512(reinterpret_cast<Bits>(flags), reinterpret_cast<Bits>(flags), 0xff) != 0;
#elif defined(__AVX2__)
    return __builtin_ia32_movmskps256(reinterpret_cast<Lanes>(flags)) != 0;
#elif defined(__SSE2__)
    return __builtin_ia32_movmskps(reinterpret_cast<Lanes>(flags)) != 0;
#else
    std::int32_t all = 0;
    for (std::size_t k = 0; k < width; ++k) all |= flags[k];
    return all != 0;
#endif
}

OpenPoint first_open(const PlacedPoints& points, std::size_t i, std::size_t end, const std::uint64_t* taken,
                     std::size_t bucket, std::size_t mask, const ChosenNear& near)
{
    for (; i < end; ++i) {
        const std::size_t cell = points.cell[i];
        if (taken[cell / 64] >> cell % 64 & 1) continue;
        if ((cell & mask) != bucket) return {i, false};
        const float x = points.x[i], y = points.y[i], z = points.z[i];
        bool covered = false;
        Flags perhaps{};
        for (std::size_t n = 0; n < near.count && !covered; n += width) {
            const Lanes dx = lanes_at(near.x + n) - x, dy = lanes_at(near.y + n) - y, dz = lanes_at(near.z + n) - z;
            const Lanes squared = dx * dx + dy * dy + dz * dz;
            covered = any(squared < surely_inside);
            perhaps |= squared < surely_outside;
        }
        if (!covered) return {i, !any(perhaps)};
    }
    return {end, false};
}

}  // namespace
}  // namespace pcm
