// Vectors of three coordinates and their algebra.
//
// Results decide bytes on disk and pictures: the order of the floating-point operations must not change. Vectors are
// std::arrays, so the operators are found from within namespace pcm only, not by argument-dependent lookup.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace pcm {

using Vec3d = std::array<double, 3>;
using Vec3i = std::array<std::int64_t, 3>;  // positions on a grid

inline constexpr double pi = 3.14159265358979323846;

inline Vec3d operator+(const Vec3d& a, const Vec3d& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3d operator-(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3d operator*(double s, const Vec3d& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline Vec3d operator/(const Vec3d& a, double s) { return {a[0] / s, a[1] / s, a[2] / s}; }

// Summed from the first coordinate to the last. For fixed `a`, monotonic in each coordinate of `b`, rounding included.
inline double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3d cross(const Vec3d& a, const Vec3d& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Without intermediate overflow or underflow, but slow. Inner loops use std::sqrt(dot(v, v)), which is good for lengths
// from 1e-150 to 1e150 and may differ in the last bit.
inline double length(const Vec3d& v) { return std::hypot(v[0], v[1], v[2]); }
// v / length(v); NaN for a vector of length 0.
inline Vec3d normalised(const Vec3d& v) { return v / length(v); }

inline double largest_magnitude(const Vec3d& v)
{
    return std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])});
}
inline bool is_finite(const Vec3d& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

// Square of the distance between two points; monotonic in each |p[a] - q[a]|, rounding included.
inline double squared_distance(const Vec3d& p, const Vec3d& q)
{
    const double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return (x * x + y * y) + z * z;
}

// The same for integer coordinates; `squared_scale` are the squares of the grid's steps. Symmetric in p and q.
// Differences below 2^53 steps are exact; they must not overflow the integer type.
template <class Integer>
double squared_distance(const std::array<Integer, 3>& p, const std::array<Integer, 3>& q, const Vec3d& squared_scale)
{
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const double d = static_cast<double>(p[a] > q[a] ? p[a] - q[a] : q[a] - p[a]);
        sum += d * d * squared_scale[a];
    }
    return sum;
}

}  // namespace pcm
