// Mean, standard deviation and median of very many numbers, exact and in bounded memory.
//
// The numbers are given by a function that calls its argument with all of them, some at a time: `for_each(see)` calls
// see(const double* values, std::size_t count). It is called several times and has to give the same numbers. They are
// finite and not negative.
#pragma once

#include "pcm/filter/compensated_sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pcm {

struct MeanAndDeviation {
    double mean = 0;
    double deviation = 0;  // sqrt(sum((v - mean)^2) / n)
};

// In stages: the smallest, the mean above the smallest, the deviation from the mean. So the deviation of equal numbers
// is exactly 0. 0 and 0 of no numbers.
template <class ForEach>
MeanAndDeviation mean_and_deviation(const ForEach& for_each)
{
    double least = HUGE_VAL;
    std::uint64_t n = 0;
    for_each([&](const double* values, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) least = std::min(least, values[i]);
        n += count;
    });
    if (n == 0) return {};
    CompensatedSum above, squares;
    for_each([&](const double* values, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) above.add(values[i] - least);
    });
    const double mean_above = above.value() / static_cast<double>(n);
    for_each([&](const double* values, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            const double d = (values[i] - least) - mean_above;
            squares.add(d * d);
        }
    });
    return {least + mean_above, std::sqrt(squares.value() / static_cast<double>(n))};
}

// The number of the given rank (0: the smallest) of f(v) for all numbers v; f(v) is not negative. Exact: a radix
// selection on the bits of the doubles, 20 at a time, until at most 2^16 candidates are left. The rank must be below
// the count of the numbers.
template <class ForEach, class F>
double value_of_rank(const ForEach& for_each, std::uint64_t rank, const F& f)
{
    const auto bits_of = [&](double v) {
        const double x = f(v) + 0.0;  // no negative zero
        std::uint64_t bits;
        std::memcpy(&bits, &x, sizeof bits);
        return bits;
    };
    constexpr unsigned digit = 20;
    constexpr std::uint64_t few = 1 << 16;
    std::uint64_t prefix = 0, candidates = ~std::uint64_t{0};
    unsigned known = 0;  // bits of the prefix
    std::vector<std::uint64_t> counts;
    while (known < 64 && candidates > few) {
        const unsigned bits = std::min(digit, 64 - known), shift = 64 - known - bits;
        counts.assign(std::size_t(1) << bits, 0);
        for_each([&](const double* values, std::size_t count) {
            for (std::size_t i = 0; i < count; ++i) {
                const std::uint64_t b = bits_of(values[i]);
                if (known == 0 || b >> (64 - known) == prefix) ++counts[(b >> shift) & ((1u << bits) - 1)];
            }
        });
        std::size_t bucket = 0;
        while (rank >= counts[bucket]) rank -= counts[bucket++];
        candidates = counts[bucket];
        prefix = prefix << bits | bucket;
        known += bits;
    }
    std::uint64_t result = prefix;
    if (known < 64) {
        std::vector<std::uint64_t> left;
        for_each([&](const double* values, std::size_t count) {
            for (std::size_t i = 0; i < count; ++i)
                if (const std::uint64_t b = bits_of(values[i]); b >> (64 - known) == prefix) left.push_back(b);
        });
        const auto at = left.begin() + static_cast<std::ptrdiff_t>(rank);
        std::nth_element(left.begin(), at, left.end());
        result = *at;
    }
    double value;
    std::memcpy(&value, &result, sizeof value);
    return value;
}

// The middle one of f(v), or the mean of the two middle ones. `count`: how many numbers, at least 1.
template <class ForEach, class F>
double median_of(const ForEach& for_each, std::uint64_t count, const F& f)
{
    const double high = value_of_rank(for_each, count / 2, f);
    if (count % 2) return high;
    const double low = value_of_rank(for_each, count / 2 - 1, f);
    return low + (high - low) / 2;
}

}  // namespace pcm
