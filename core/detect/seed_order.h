// The order in which a search tries the points of a sample.
#pragma once

#include "pcm/detect/shape_growth.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcm {

// The finalizer of SplitMix64 (Steele, Lea, Flood 2014): an even choice of 64 bits for each number.
inline std::uint64_t mixed(std::uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

// The free points of the box, by rank(i), 0 to 63 in whole steps, and within one rank at random, as `seed` decides.
template <class Rank>
std::vector<std::uint32_t> seeds_in_order(const SurfaceSample& sample, const ShapeGrowth& growth, std::uint64_t seed,
                                          const Rank& rank)
{
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::uint32_t i = 0; i < sample.size(); ++i) {
        if (!growth.is_free(i) || !sample.inside[i]) continue;
        const auto bin = static_cast<std::uint64_t>(std::clamp(static_cast<double>(rank(i)), 0.0, 63.0));
        order.push_back({bin << 56 | mixed(i * 2654435761u + seed) >> 8, i});
    }
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> seeds;
    for (const auto& entry : order) seeds.push_back(entry.second);
    return seeds;
}

}  // namespace pcm
