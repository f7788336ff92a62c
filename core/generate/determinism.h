// Random numbers and elementary functions that give the same bits on every machine.
//
// The C library's sin, cos and log may differ in the last bit between versions and processors; these use only +, -, *,
// / and sqrt, which IEEE 754 fixes (and which the compiler must not fuse: -ffp-contract=off).
#pragma once

#include "pcm/cloud/vector.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace pcm::scene {

// Steele, Lea, Flood: Fast splittable pseudorandom number generators (2014), the finaliser of SplitMix64.
inline std::uint64_t mix(std::uint64_t x)
{
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

inline std::uint64_t hash(std::uint64_t a, std::uint64_t b)
{
    return mix(mix(a + 0x9E3779B97F4A7C15u) ^ (b + 0x632BE59BD9B4E019u));
}

// 0 <= unit < 1
inline double to_unit(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

// The largest integer at or below x; |x| must be far below 2^63. (std::floor is a function call on plain x86-64.)
inline std::int64_t whole_below(double x)
{
    const auto toward_zero = static_cast<std::int64_t>(x);
    return toward_zero - (static_cast<double>(toward_zero) > x ? 1 : 0);
}

// Sine and cosine of `turns` full turns, to about 1e-15.
inline void sine_cosine(double turns, double& sine, double& cosine)
{
    const std::int64_t quarter = whole_below(4.0 * turns + 0.5);
    const double x = (turns - 0.25 * static_cast<double>(quarter)) * (2 * pi);  // within a quarter of pi
    const double y = x * x;
    // Taylor series; the first terms left out are below 1e-15.
    double s = 1.0 / 6227020800 + y * (-1.0 / 1307674368000);
    s = 1.0 / 362880 + y * (-1.0 / 39916800 + y * s);
    s = x * (1 + y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 + y * s))));
    double c = 1.0 / 479001600 + y * (-1.0 / 87178291200);
    c = 1.0 / 40320 + y * (-1.0 / 3628800 + y * c);
    c = 1 + y * (-1.0 / 2 + y * (1.0 / 24 + y * (-1.0 / 720 + y * c)));
    // Without branches, because the quarter cannot be predicted.
    const bool odd = quarter & 1;
    sine = (odd ? c : s) * static_cast<double>(1 - (quarter & 2));
    cosine = (odd ? s : c) * static_cast<double>(1 - ((quarter + 1) & 2));
}

// Natural logarithm of a positive normal number, to about 1e-14.
inline double logarithm(double x)
{
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    std::int64_t exponent = static_cast<std::int64_t>(bits >> 52) - 1023;
    bits = (bits & 0x000FFFFFFFFFFFFFu) | 0x3FF0000000000000u;
    double m;
    std::memcpy(&m, &bits, sizeof m);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        ++exponent;
    }
    const double s = (m - 1) / (m + 1);
    const double y = s * s;
    double series = 1.0 / 13 + y * (1.0 / 15 + y * (1.0 / 17 + y * (1.0 / 19)));
    series = 1.0 / 7 + y * (1.0 / 9 + y * (1.0 / 11 + y * series));
    series = 2 * s * (1 + y * (1.0 / 3 + y * (1.0 / 5 + y * series)));
    return series + static_cast<double>(exponent) * 0.693147180559945309417;
}

// SplitMix64: one stream per key, so that any point can be generated without the points before it.
class Random {
public:
    explicit Random(std::uint64_t key) : state_(mix(key)) {}

    std::uint64_t bits() { return mix(state_ += 0x9E3779B97F4A7C15u); }
    double unit() { return to_unit(bits()); }
    double between(double low, double high) { return low + (high - low) * unit(); }
    int below(int count) { return static_cast<int>(unit() * count); }
    bool chance(double probability) { return unit() < probability; }

    // Standard normal, clamped to [-6, 6] (Box and Muller 1958): every point lies within 6 sigma of its primitive.
    double normal()
    {
        const double radius = std::sqrt(-2 * logarithm(1 - unit()));
        double sine, cosine;
        sine_cosine(unit(), sine, cosine);
        const double value = radius * cosine;
        return value > 6 ? 6 : value < -6 ? -6 : value;
    }

private:
    std::uint64_t state_;
};

}  // namespace pcm::scene
