// Products of vectors whose parts cancel: without the loss of digits of the plain formulas.
#pragma once

#include "pcm/cloud/vector.h"

#include <cmath>

namespace pcm {

// a b - c d to 1.5 units in the last place (Kahan; Jeannerod, Louvet and Muller 2013). Without overflow or underflow.
inline double difference_of_products(double a, double b, double c, double d)
{
    const double product = c * d;
    return std::fma(a, b, -product) + std::fma(-c, d, product);
}

inline Vec3d exact_cross(const Vec3d& a, const Vec3d& b)
{
    return {difference_of_products(a[1], b[2], a[2], b[1]), difference_of_products(a[2], b[0], a[0], b[2]),
            difference_of_products(a[0], b[1], a[1], b[0])};
}

// As if in twice the precision, then rounded (Ogita, Rump and Oishi 2005, Dot2).
inline double exact_dot(const Vec3d& a, const Vec3d& b)
{
    double sum = 0, error = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double product = a[k] * b[k], next = sum + product, part = next - sum;
        error += std::fma(a[k], b[k], -product) + ((sum - (next - part)) + (product - part));
        sum = next;
    }
    return sum + error;
}

// What a - b loses when it is rounded: (a - b) + lost_in_difference(a, b) is the difference exactly (Knuth's two-sum).
inline Vec3d lost_in_difference(const Vec3d& a, const Vec3d& b)
{
    Vec3d lost;
    for (std::size_t k = 0; k < 3; ++k) {
        const double d = a[k] - b[k], part = d - a[k];
        lost[k] = (a[k] - (d - part)) - (b[k] + part);
    }
    return lost;
}

}  // namespace pcm
