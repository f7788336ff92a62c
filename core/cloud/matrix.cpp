#include "pcm/cloud/matrix.h"

#include <algorithm>
#include <cmath>

namespace pcm {

bool is_finite(const Matrix4d& m)
{
    return std::all_of(m.begin(), m.end(), [](double v) { return std::isfinite(v); });
}

bool is_affine(const Matrix4d& m) { return m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] != 0 && is_finite(m); }

Matrix4d product(const Matrix4d& a, const Matrix4d& b)
{
    Matrix4d m{};
    for (std::size_t column = 0; column < 4; ++column)
        for (std::size_t row = 0; row < 4; ++row)
            for (std::size_t k = 0; k < 4; ++k) m[column * 4 + row] += a[k * 4 + row] * b[column * 4 + k];
    return m;
}

// The adjugate of the upper left over the determinant.
std::optional<Matrix4d> affine_inverse(const Matrix4d& m)
{
    const auto at = [&](std::size_t row, std::size_t column) { return m[column * 4 + row]; };
    Matrix4d inverse{};
    double determinant = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t r1 = (i + 1) % 3, r2 = (i + 2) % 3, c1 = (j + 1) % 3, c2 = (j + 2) % 3;
            const double cofactor = at(r1, c1) * at(r2, c2) - at(r1, c2) * at(r2, c1);
            inverse[i * 4 + j] = cofactor;  // transposed
            if (i == 0) determinant += at(0, j) * cofactor;
        }
    if (determinant == 0 || !std::isfinite(1 / determinant)) return std::nullopt;
    for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t row = 0; row < 3; ++row) inverse[column * 4 + row] /= determinant;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < 3; ++k) inverse[12 + row] -= inverse[k * 4 + row] * m[12 + k];
    inverse[15] = 1;
    return inverse;
}

}  // namespace pcm
