// Eigenvalues and eigenvectors of small symmetric matrices.
#pragma once

#include "pcm/cloud/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace pcm {

template <std::size_t N>
using SquareMatrix = std::array<std::array<double, N>, N>;

template <std::size_t N>
struct Eigensystem {
    std::array<double, N> values{};  // ascending
    SquareMatrix<N> vectors{};       // rows: unit, orthogonal
};

namespace detail {

// Makes element (p, q) zero, and turns the vectors accordingly.
template <std::size_t N>
void rotate(SquareMatrix<N>& a, SquareMatrix<N>& vectors, std::size_t p, std::size_t q)
{
    if (a[p][q] == 0) return;
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = (theta < 0 ? -1.0 : 1.0) / (std::fabs(theta) + std::hypot(theta, 1.0));
    const double c = 1 / std::hypot(t, 1.0), s = t * c;
    const double pq = a[p][q];
    a[p][p] -= t * pq;
    a[q][q] += t * pq;
    a[p][q] = a[q][p] = 0;
    for (std::size_t i = 0; i < N; ++i) {
        if (i != p && i != q) {
            const double pi = a[p][i], qi = a[q][i];
            a[p][i] = a[i][p] = c * pi - s * qi;
            a[q][i] = a[i][q] = s * pi + c * qi;
        }
        const double v = vectors[p][i], w = vectors[q][i];
        vectors[p][i] = c * v - s * w;
        vectors[q][i] = s * v + c * w;
    }
}

}  // namespace detail

// By cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 8.5): accurate to some 1e-15 of the largest
// eigenvalue for any finite matrix, equal eigenvalues included. Elements from 1e-300 to 1e300.
template <std::size_t N>
Eigensystem<N> eigensystem(SquareMatrix<N> a)
{
    SquareMatrix<N> vectors{};
    double size = 0;
    for (std::size_t i = 0; i < N; ++i) {
        vectors[i][i] = 1;
        for (const double element : a[i]) size = std::max(size, std::fabs(element));
    }
    if (!(size > 0)) return {{}, vectors};
    for (auto& row : a)
        for (double& element : row) element /= size;
    // Converges quadratically: 4 to 6 rounds of 3 x 3 elements.
    for (int round = 0; round < 30; ++round) {
        double rest = 0;
        for (std::size_t p = 0; p < N; ++p)
            for (std::size_t q = p + 1; q < N; ++q) rest += std::fabs(a[p][q]);
        if (rest < 1e-200) break;
        for (std::size_t p = 0; p < N; ++p)
            for (std::size_t q = p + 1; q < N; ++q) detail::rotate(a, vectors, p, q);
    }
    std::array<std::size_t, N> order{};
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a[i][i] < a[j][j]; });
    Eigensystem<N> result;
    for (std::size_t i = 0; i < N; ++i) {
        result.values[i] = a[order[i]][order[i]] * size;
        result.vectors[i] = vectors[order[i]];
    }
    return result;
}

struct SymmetricMatrix {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

Eigensystem<3> eigensystem(const SymmetricMatrix& matrix);

struct SmallestEigenvector {
    Vec3d values{};  // ascending; the smallest accurate to some 1e-15 of the largest, the others to 1e-8
    Vec3d vector{};  // unit, of the smallest eigenvalue; 0 for a matrix of zeros
};

// The same for the smallest eigenvector alone, many times as fast where the two smaller eigenvalues differ by more than
// a thousandth of the largest: in closed form (trigonometric roots of the characteristic polynomial, cross products of
// rows); else by eigensystem(). Where every vector of a plane is one of the smallest eigenvalue (points on a line), it
// is the one nearest to the z axis.
SmallestEigenvector smallest_eigenvector(const SymmetricMatrix& matrix);

}  // namespace pcm
