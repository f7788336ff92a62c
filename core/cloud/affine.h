// Affine maps of space.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <cmath>

namespace pcm {

// Maps p to linear * (p - pivot) + target. With a pivot near the points, no large numbers are subtracted: a rotation at
// map coordinates is as exact as one at the origin.
struct Affine {
    std::array<Vec3d, 3> linear{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  // rows
    Vec3d pivot{0, 0, 0}, target{0, 0, 0};

    static Affine translation(const Vec3d& by)
    {
        return {{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}, {0, 0, 0}, by};
    }
    // Rotation about an axis through `centre` (Rodrigues' formula), counter-clockwise as seen from the tip of the axis,
    // which has any length but 0; also scales about the centre.
    static Affine rotation(const Vec3d& axis, double radians, const Vec3d& centre, double scale = 1)
    {
        const double c = std::cos(radians), s = std::sin(radians);
        const Vec3d u = normalised(axis);
        Affine affine;
        affine.pivot = affine.target = centre;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                const std::size_t k = 3 - i - j;
                const double cross = i == j ? 0 : ((j + 1) % 3 == i ? u[k] : -u[k]) * s;
                affine.linear[i][j] = scale * ((i == j ? c : 0) + (1 - c) * u[i] * u[j] + cross);
            }
        return affine;
    }
    // The map linear * p + shift, evaluated about a given pivot.
    static Affine about(const std::array<Vec3d, 3>& linear, const Vec3d& shift, const Vec3d& pivot)
    {
        Affine affine{linear, pivot, shift};
        for (std::size_t i = 0; i < 3; ++i)
            affine.target[i] = static_cast<double>(
                static_cast<long double>(shift[i]) + static_cast<long double>(linear[i][0]) * pivot[0] +
                static_cast<long double>(linear[i][1]) * pivot[1] + static_cast<long double>(linear[i][2]) * pivot[2]);
        return affine;
    }

    Vec3d operator()(const Vec3d& p) const
    {
        const Vec3d d = p - pivot;
        Vec3d q;
        for (std::size_t i = 0; i < 3; ++i) q[i] = dot(linear[i], d) + target[i];
        return q;
    }
    double determinant() const
    {
        const auto& m = linear;
        return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    }
};

}  // namespace pcm
