// Included by one source per level of system/cpu.h. No inline function of another header is used: see there.
#pragma once

#include "pcm/build/nodes/size_loops.h"
#include "pcm/system/vector_bytes.h"

#include <cstdint>

namespace pcm {

namespace {

template <class Real>
struct LanesOf;
template <>
struct LanesOf<float> {
    using Type = float __attribute__((vector_size(vector_bytes)));
    using Flags = std::int32_t __attribute__((vector_size(vector_bytes)));
};
template <>
struct LanesOf<double> {
    using Type = double __attribute__((vector_size(vector_bytes)));
    using Flags = std::int64_t __attribute__((vector_size(vector_bytes)));
};

// One vector of a group's points.
template <class Real>
struct Targets {
    using Lanes = typename LanesOf<Real>::Type;
    using Flags = typename LanesOf<Real>::Flags;
    static constexpr std::size_t width = vector_bytes / sizeof(Real);

    Lanes x, y, z;
    Flags index;                     // in the group
    Lanes nearest[size_neighbours];  // squares of the distances to the nearest points found so far, nearest first

    void start(const Real* group, std::size_t first)
    {
        __builtin_memcpy(&x, group + first, sizeof x);
        __builtin_memcpy(&y, group + size_group + first, sizeof y);
        __builtin_memcpy(&z, group + 2 * size_group + first, sizeof z);
        index = Flags{} + static_cast<std::int32_t>(first);
        for (std::size_t k = 1; k < width; ++k) index[k] += static_cast<std::int32_t>(k);
        for (Lanes& rank : nearest) rank = Lanes{} + static_cast<Real>(__builtin_inf());
    }

    // Offers point j of a group; `own`: the points' own group, where a point is not offered itself.
    template <bool own>
    void offer(const Real* group, std::size_t j)
    {
        const Lanes dx = x - group[j], dy = y - group[size_group + j], dz = z - group[2 * size_group + j];
        Lanes d = dx * dx + dy * dy + dz * dz;
        if constexpr (own) d = index == static_cast<std::int32_t>(j) ? Lanes{} + static_cast<Real>(__builtin_inf()) : d;
        for (std::size_t n = 0; n + 1 < size_neighbours; ++n) {
            const Lanes nearer = d < nearest[n] ? d : nearest[n];
            d = nearest[n] < d ? d : nearest[n];
            nearest[n] = nearer;
        }
        Lanes& last = nearest[size_neighbours - 1];
        last = d < last ? d : last;
    }

    // The squares of the distances to the last neighbour that there is.
    Lanes last_neighbour() const
    {
        const Lanes infinite = Lanes{} + static_cast<Real>(__builtin_inf());
        Lanes last{};
        for (const Lanes& rank : nearest) last = rank < infinite ? rank : last;
        return last;
    }
};

template <class Real>
void find_distances(const Real* groups, std::size_t count, float* to)
{
    constexpr std::size_t group_values = 3 * size_group, width = Targets<Real>::width;
    constexpr std::size_t together = 2;  // vectors, so that their instructions overlap
    static_assert(size_group % (together * width) == 0);
    for (std::size_t g = 0; g < count; ++g) {
        const Real* own = groups + g * group_values;
        for (std::size_t first = 0; first < size_group; first += together * width) {
            Targets<Real> targets[together];
            for (std::size_t t = 0; t < together; ++t) targets[t].start(own, first + t * width);
            if (g > 0)
                for (std::size_t j = 0; j < size_group; ++j)
                    for (Targets<Real>& target : targets) target.template offer<false>(own - group_values, j);
            for (std::size_t j = 0; j < size_group; ++j)
                for (Targets<Real>& target : targets) target.template offer<true>(own, j);
            if (g + 1 < count)
                for (std::size_t j = 0; j < size_group; ++j)
                    for (Targets<Real>& target : targets) target.template offer<false>(own + group_values, j);
            Real squares[together * width];
            for (std::size_t t = 0; t < together; ++t) {
                const auto last = targets[t].last_neighbour();
                __builtin_memcpy(squares + t * width, &last, sizeof last);
            }
            for (std::size_t k = 0; k < together * width; ++k) {
                if constexpr (sizeof(Real) == sizeof(float))
                    to[g * size_group + first + k] = __builtin_sqrtf(squares[k]);
                else
                    to[g * size_group + first + k] = static_cast<float>(__builtin_sqrt(squares[k]));
            }
        }
    }
}

// Groups are sorted side by side, one per lane, by Batcher's odd-even merging.
void find_middles(const float* distances, std::size_t count, float* to)
{
    using Lanes = LanesOf<float>::Type;
    constexpr std::size_t width = vector_bytes / sizeof(float);
    for (std::size_t g = 0; g < count; g += width) {
        Lanes values[size_group];
        for (std::size_t l = 0; l < width; ++l) {
            const float* group = distances + (g + l < count ? g + l : g) * size_group;
            for (std::size_t k = 0; k < size_group; ++k) values[k][l] = group[k];
        }
        for (std::size_t sorted = 1; sorted < size_group; sorted *= 2)
            for (std::size_t step = sorted; step >= 1; step /= 2)
                for (std::size_t first = step % sorted; first + step < size_group; first += 2 * step)
                    for (std::size_t i = first; i < first + step && i + step < size_group; ++i) {
                        if (i / (2 * sorted) != (i + step) / (2 * sorted)) continue;
                        const Lanes low = values[i], high = values[i + step];
                        values[i] = high < low ? high : low;
                        values[i + step] = low < high ? high : low;
                    }
        for (std::size_t l = 0; l < width && g + l < count; ++l) to[g + l] = values[size_group / 2][l];
    }
}

}  // namespace
}  // namespace pcm
