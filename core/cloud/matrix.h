// 4x4 matrices in double, column-major like OpenGL's: element (row, column) is m[column * 4 + row].
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace pcm {

using Matrix4d = std::array<double, 16>;

inline constexpr Matrix4d identity_matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

Matrix4d product(const Matrix4d& a, const Matrix4d& b);

bool is_finite(const Matrix4d& m);

// Whether all elements are finite and the last row is 0 0 0 w with w not 0.
bool is_affine(const Matrix4d& m);

// The inverse of an affine matrix whose last element is 1; absent when it is singular.
std::optional<Matrix4d> affine_inverse(const Matrix4d& m);

}  // namespace pcm
