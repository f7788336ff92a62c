// Eigenvalues and eigenvectors of small symmetric matrices.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pcm {

template <std::size_t N>
using SquareMatrix = std::array<std::array<double, N>, N>;

template <std::size_t N>
struct SymmetricSystem {
    std::array<double, N> values{};  // descending
    SquareMatrix<N> vectors{};       // rows: unit, orthogonal
};

// Cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 8.5): eigenvalues accurate to some 1e-15 of the
// largest. Elements are to be finite and around 1.
template <std::size_t N>
SymmetricSystem<N> symmetric_system(SquareMatrix<N> a)
{
    SquareMatrix<N> v{};
    for (std::size_t i = 0; i < N; ++i) v[i][i] = 1;
    for (int sweep = 0; sweep < 60; ++sweep) {
        double off = 0, all = 0;
        for (std::size_t i = 0; i < N; ++i)
            for (std::size_t j = 0; j < N; ++j) (i == j ? all : off) += a[i][j] * a[i][j];
        if (!(off > 1e-34 * (all + off))) break;
        for (std::size_t p = 0; p < N; ++p)
            for (std::size_t q = p + 1; q < N; ++q) {
                if (a[p][q] == 0) continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::hypot(theta, 1.0));
                const double c = 1 / std::hypot(t, 1.0), s = t * c;
                for (std::size_t k = 0; k < N; ++k) {
                    const double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (std::size_t k = 0; k < N; ++k) {
                    const double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                    const double u = v[p][k], w = v[q][k];
                    v[p][k] = c * u - s * w;
                    v[q][k] = s * u + c * w;
                }
                a[p][q] = a[q][p] = 0;
            }
    }
    SymmetricSystem<N> result;
    for (std::size_t i = 0; i < N; ++i) result.values[i] = a[i][i];
    result.vectors = v;
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = i + 1; j < N; ++j)
            if (result.values[j] > result.values[i]) {
                std::swap(result.values[i], result.values[j]);
                std::swap(result.vectors[i], result.vectors[j]);
            }
    return result;
}

}  // namespace pcm
