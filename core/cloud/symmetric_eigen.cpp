#include "pcm/cloud/symmetric_eigen.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcm {
namespace {

double largest_element(const SymmetricMatrix& m)
{
    return std::max(
        {std::fabs(m.xx), std::fabs(m.xy), std::fabs(m.xz), std::fabs(m.yy), std::fabs(m.yz), std::fabs(m.zz)});
}

SymmetricMatrix scaled(const SymmetricMatrix& m, double by)
{
    return {m.xx / by, m.xy / by, m.xz / by, m.yy / by, m.yz / by, m.zz / by};
}

// The vector of the plane of the two smaller eigenvalues that is nearest to the z axis.
Vec3d upright(const Vec3d& line)
{
    const Vec3d up = std::fabs(line[2]) < 0.99999 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
    return normalised(up - dot(up, line) * line);
}

}  // namespace

Eigensystem<3> eigensystem(const SymmetricMatrix& m)
{
    Eigensystem<3> result =
        eigensystem<3>(SquareMatrix<3>{{{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}}});
    for (Vec3d& vector : result.vectors) vector = normalised(vector);
    return result;
}

SmallestEigenvector smallest_eigenvector(const SymmetricMatrix& matrix)
{
    const double size = largest_element(matrix);
    if (!(size > 0)) return {};
    const SymmetricMatrix m = scaled(matrix, size);
    const auto by_rotations = [&] {
        const Eigensystem<3> all = eigensystem(matrix);
        const bool line = all.values[1] - all.values[0] <= 1e-13 * all.values[2] && all.values[1] < all.values[2] / 2;
        return SmallestEigenvector{all.values, line ? upright(all.vectors[2]) : all.vectors[0]};
    };
    const double q = (m.xx + m.yy + m.zz) / 3, x = m.xx - q, y = m.yy - q, z = m.zz - q;
    const double squares = x * x + y * y + z * z + 2 * (m.xy * m.xy + m.xz * m.xz + m.yz * m.yz);
    const double p = std::sqrt(squares / 6);
    if (!(p > 1e-3)) return by_rotations();
    const double determinant =
        x * (y * z - m.yz * m.yz) - m.xy * (m.xy * z - m.yz * m.xz) + m.xz * (m.xy * m.yz - y * m.xz);
    const double angle = std::acos(std::clamp(determinant / (2 * p * p * p), -1.0, 1.0)) / 3;
    const double high = q + 2 * p * std::cos(angle), low = q + 2 * p * std::cos(angle + 2 * pi / 3);
    if (!(3 * q - high - 2 * low > 1e-3 * high)) return by_rotations();  // middle - low
    const Vec3d rows[3] = {{m.xx - low, m.xy, m.xz}, {m.xy, m.yy - low, m.yz}, {m.xz, m.yz, m.zz - low}};
    Vec3d best{};
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d across = cross(rows[i], rows[(i + 1) % 3]);
        const double square = dot(across, across);
        if (square > longest) longest = square, best = across;
    }
    if (!(longest > 1e-20)) return by_rotations();
    const Vec3d n = best / std::sqrt(longest);
    // The Rayleigh quotient, whose error is the square of the vector's.
    const Vec3d an{m.xx * n[0] + m.xy * n[1] + m.xz * n[2], m.xy * n[0] + m.yy * n[1] + m.yz * n[2],
                   m.xz * n[0] + m.yz * n[1] + m.zz * n[2]};
    const double smallest = dot(n, an);
    return {{smallest * size, (3 * q - high - smallest) * size, high * size}, n};
}

}  // namespace pcm
