// Sums in four lanes, which compilers turn into vectors.
#pragma once

#include <cstddef>

namespace pcm {

inline constexpr std::size_t sum_lanes = 4;

inline double sum_of_lanes(const double (&lane)[sum_lanes]) { return (lane[0] + lane[1]) + (lane[2] + lane[3]); }

// The sum of term(j), j < count.
template <class Term>
double lane_sum(std::size_t count, const Term& term)
{
    double lane[sum_lanes] = {};
    std::size_t j = 0;
    for (; j + sum_lanes <= count; j += sum_lanes)
        for (std::size_t l = 0; l < sum_lanes; ++l) lane[l] += term(j + l);
    for (; j < count; ++j) lane[0] += term(j);
    return sum_of_lanes(lane);
}

}  // namespace pcm
