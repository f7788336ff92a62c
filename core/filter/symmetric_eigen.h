// Eigenvalues and eigenvectors of symmetric 3 x 3 matrices.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>

namespace pcm {

struct SymmetricMatrix {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

struct Eigensystem {
    Vec3d values{};                  // ascending
    std::array<Vec3d, 3> vectors{};  // unit, orthogonal
};

// By Jacobi rotations: accurate to some 1e-15 of the largest eigenvalue for any finite matrix, equal eigenvalues
// included. Elements from 1e-300 to 1e300.
Eigensystem eigensystem(const SymmetricMatrix& matrix);

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
