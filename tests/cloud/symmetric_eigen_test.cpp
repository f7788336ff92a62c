#include "pcm/cloud/symmetric_eigen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace pcm;

struct Built {
    SymmetricMatrix matrix;
    std::array<Vec3d, 3> axes;
};

// The matrix with given eigenvalues about random axes.
Built with_values(const Vec3d& values, std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    const Vec3d a = normalised({normal(random), normal(random), normal(random)});
    const Vec3d b = normalised(cross(a, {normal(random), normal(random), normal(random)}));
    Built built{{}, {a, b, cross(a, b)}};
    double* const elements[] = {&built.matrix.xx, &built.matrix.xy, &built.matrix.xz,
                                &built.matrix.yy, &built.matrix.yz, &built.matrix.zz};
    const std::size_t rows[] = {0, 0, 0, 1, 1, 2}, columns[] = {0, 1, 2, 1, 2, 2};
    for (std::size_t e = 0; e < 6; ++e)
        for (std::size_t i = 0; i < 3; ++i)
            *elements[e] += values[i] * built.axes[i][rows[e]] * built.axes[i][columns[e]];
    return built;
}

Vec3d times(const SymmetricMatrix& m, const Vec3d& v)
{
    return {m.xx * v[0] + m.xy * v[1] + m.xz * v[2], m.xy * v[0] + m.yy * v[1] + m.yz * v[2],
            m.xz * v[0] + m.yz * v[1] + m.zz * v[2]};
}

const std::vector<Vec3d> spectra{{1, 2, 3},         {0, 1, 1},
                                 {0, 0, 1},         {1, 1, 1},
                                 {1e-12, 1, 1.5},   {0, 1e-6, 1},
                                 {1e-9, 2e-9, 1},   {1, 1 + 1e-12, 2},
                                 {1, 2, 2 + 1e-13}, {0.3, 0.3, 0.9},
                                 {0, 1e-3, 1},      {0, 1.1e-3, 1},
                                 {5e-4, 2e-3, 1},   {0.999999, 1, 1.0001}};

TEST(SymmetricEigen, RotationsSolveEveryMatrix)
{
    std::mt19937_64 random(1);
    for (const double size : {1e-60, 1e-18, 1.0, 1e18, 1e60})
        for (const Vec3d& values : spectra)
            for (int turn = 0; turn < 20; ++turn) {
                const Built built = with_values(size * values, random);
                const Eigensystem<3> all = eigensystem(built.matrix);
                for (std::size_t i = 0; i < 3; ++i) {
                    EXPECT_NEAR(all.values[i] / size, values[i], 4e-15 * values[2]);
                    const Vec3d rest = times(built.matrix, all.vectors[i]) - all.values[i] * all.vectors[i];
                    EXPECT_LE(length(rest), 1e-14 * size * values[2]);
                    for (std::size_t j = 0; j < 3; ++j)
                        EXPECT_NEAR(dot(all.vectors[i], all.vectors[j]), i == j ? 1 : 0, 1e-14);
                }
            }
}

// A 4 x 4 matrix is turned from known eigenvalues by planes' rotations, and solved.
TEST(SymmetricEigen, LargerMatrices)
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> angle(0, 6.28);
    const std::array<std::array<double, 4>, 5> all_values{
        {{1, 2, 3, 4}, {-1, 0, 0, 1}, {1e-12, 1e-6, 1, 1}, {2, 2, 2, 2}, {-3, -3 + 1e-9, 1e-3, 3}}};
    for (const double size : {1e-60, 1.0, 1e60})
        for (const auto& values : all_values) {
            SquareMatrix<4> matrix{};
            for (std::size_t i = 0; i < 4; ++i) matrix[i][i] = size * values[i];
            for (std::size_t p = 0; p < 4; ++p)
                for (std::size_t q = p + 1; q < 4; ++q) {
                    const double turn = angle(random), c = std::cos(turn), s = std::sin(turn);
                    for (auto& row : matrix) {
                        const double x = row[p], y = row[q];
                        row[p] = c * x - s * y, row[q] = s * x + c * y;
                    }
                    for (std::size_t i = 0; i < 4; ++i) {
                        const double x = matrix[p][i], y = matrix[q][i];
                        matrix[p][i] = c * x - s * y, matrix[q][i] = s * x + c * y;
                    }
                }
            const Eigensystem<4> system = eigensystem<4>(matrix);
            for (std::size_t i = 0; i < 4; ++i) {
                EXPECT_NEAR(system.values[i] / size, values[i], 1e-14);
                for (std::size_t j = 0; j < 4; ++j) {
                    double product = 0, image = 0;
                    for (std::size_t k = 0; k < 4; ++k) {
                        product += system.vectors[i][k] * system.vectors[j][k];
                        image += matrix[j][k] * system.vectors[i][k];
                    }
                    EXPECT_NEAR(product, i == j ? 1 : 0, 1e-14);
                    EXPECT_NEAR(image / size, system.values[i] / size * system.vectors[i][j], 2e-14);
                }
            }
        }
}

TEST(SymmetricEigen, TheSmallestVectorIsThatOfRotations)
{
    std::mt19937_64 random(2);
    for (const double size : {1e-60, 1e-18, 1.0, 1e18, 1e60})
        for (const Vec3d& values : spectra)
            for (int turn = 0; turn < 200; ++turn) {
                const Built built = with_values(size * values, random);
                const SmallestEigenvector smallest = smallest_eigenvector(built.matrix);
                EXPECT_NEAR(length(smallest.vector), 1, 1e-14);
                EXPECT_NEAR(smallest.values[0] / size, values[0], 1e-14 * values[2]);
                for (std::size_t i = 1; i < 3; ++i)
                    EXPECT_NEAR(smallest.values[i] / size, values[i], 3e-8 * values[2]) << i << " " << values[0];
                const Vec3d rest = times(built.matrix, smallest.vector) - smallest.values[0] * smallest.vector;
                EXPECT_LE(length(rest), 1e-11 * size * values[2]) << values[0] << " " << values[1] << " " << values[2];
                const double gap = (values[1] - values[0]) / values[2];
                if (gap > 1e-5) EXPECT_LE(length(cross(smallest.vector, built.axes[0])), 3e-15 / (gap * gap) + 1e-14);
            }
}

TEST(SymmetricEigen, DiagonalMatricesAndZeros)
{
    EXPECT_EQ(smallest_eigenvector({}).vector, (Vec3d{0, 0, 0}));
    EXPECT_EQ(std::fabs(smallest_eigenvector({2, 0, 0, 1, 0, 3}).vector[1]), 1);
    EXPECT_EQ(std::fabs(smallest_eigenvector({1, 0, 0, 1, 0, 0}).vector[2]), 1);
    const SmallestEigenvector huge = smallest_eigenvector({1e300, 0, 0, 2e300, 0, 3e300});
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(huge.values[i] / 1e300, double(i + 1), 1e-7);
}

TEST(SymmetricEigen, OnALineTheVectorIsTheNearestToTheZAxis)
{
    std::mt19937_64 random(3);
    for (int turn = 0; turn < 100; ++turn) {
        const Built built = with_values({0, 0, 1}, random);
        const Vec3d n = smallest_eigenvector(built.matrix).vector;
        EXPECT_NEAR(dot(n, built.axes[2]), 0, 1e-7);
        // Its height is the largest that a vector across the line can have.
        EXPECT_NEAR(n[2], std::sqrt(1 - built.axes[2][2] * built.axes[2][2]), 1e-7);
    }
    EXPECT_EQ(std::fabs(smallest_eigenvector({0, 0, 0, 0, 0, 1}).vector[2]), 0);
}

}  // namespace
