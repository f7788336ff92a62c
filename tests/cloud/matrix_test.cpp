// Products and inverses against long double.
#include "pcm/cloud/matrix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace pcm;
using Long = long double;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// An affine matrix: turned, stretched by up to 1e3 along each axis, moved to map coordinates.
Matrix4d random_affine(std::mt19937_64& random)
{
    std::uniform_real_distribution<double> unit(-1, 1);
    Matrix4d m = identity_matrix;
    for (int turn = 0; turn < 3; ++turn) {
        const double angle = 3 * unit(random), c = std::cos(angle), s = std::sin(angle);
        Matrix4d r = identity_matrix;
        const std::size_t a = static_cast<std::size_t>(turn), b = (a + 1) % 3;
        r[a * 4 + a] = r[b * 4 + b] = c;
        r[a * 4 + b] = s;
        r[b * 4 + a] = -s;
        Matrix4d scale = identity_matrix;
        scale[a * 5] = std::pow(10.0, 3 * unit(random));
        m = product(r, product(scale, m));
    }
    for (std::size_t a = 0; a < 3; ++a) m[12 + a] = 5e6 * unit(random);
    return m;
}

TEST(Matrix, ProductsAreWithinRoundingOfTheExactOnes)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 2000; ++i) {
        Matrix4d a, b;
        for (double& v : a) v = std::ldexp(unit(random), static_cast<int>(random() % 60) - 30);
        for (double& v : b) v = std::ldexp(unit(random), static_cast<int>(random() % 60) - 30);
        const Matrix4d ab = product(a, b);
        for (std::size_t row = 0; row < 4; ++row)
            for (std::size_t column = 0; column < 4; ++column) {
                Long sum = 0, size = 0;
                for (std::size_t k = 0; k < 4; ++k) {
                    const Long term = static_cast<Long>(a[k * 4 + row]) * b[column * 4 + k];
                    sum += term;
                    size += std::abs(term);
                }
                ASSERT_LE(std::abs(ab[column * 4 + row] - sum), 3 * epsilon * size);
            }
        EXPECT_EQ(product(a, identity_matrix), a);
        EXPECT_EQ(product(identity_matrix, b), b);
    }
}

// The residual of m * inverse in long double, relative to the sizes that were added up: what the adjugate in double can
// give for a condition of the linear part up to 1e6 an axis.
TEST(Matrix, AnInverseUndoesTheMatrix)
{
    std::mt19937_64 random(2);
    for (int i = 0; i < 2000; ++i) {
        const Matrix4d m = random_affine(random);
        const auto inverse = affine_inverse(m);
        ASSERT_TRUE(inverse);
        ASSERT_TRUE(is_affine(*inverse));
        EXPECT_EQ((*inverse)[15], 1);
        for (std::size_t row = 0; row < 3; ++row)
            for (std::size_t column = 0; column < 4; ++column) {
                Long sum = column == 3 ? m[12 + row] : 0, size = std::abs(sum);
                for (std::size_t k = 0; k < 3; ++k) {
                    const Long term = static_cast<Long>(m[k * 4 + row]) * (*inverse)[column * 4 + k];
                    sum += term;
                    size += std::abs(term);
                }
                ASSERT_NEAR(static_cast<double>(sum), row == column ? 1 : 0, 1e-10 * (1 + static_cast<double>(size)))
                    << i << ": " << row << ", " << column;
            }
    }
}

TEST(Matrix, SingularOnesHaveNoInverse)
{
    std::mt19937_64 random(3);
    Matrix4d m = random_affine(random);
    for (std::size_t r = 0; r < 3; ++r) m[4 + r] = 2 * m[r];  // the second column is twice the first: an exact zero
    EXPECT_FALSE(affine_inverse(m));
    EXPECT_FALSE(affine_inverse(Matrix4d{}));
    m = identity_matrix;
    for (std::size_t a = 0; a < 3; ++a) m[a * 5] = 1e-120;  // the determinant is below all doubles
    EXPECT_FALSE(affine_inverse(m));
    m[0] = std::nan("");
    EXPECT_FALSE(affine_inverse(m));
}

TEST(Matrix, AffineIsFiniteWithALastRowThatOnlyScales)
{
    EXPECT_TRUE(is_affine(identity_matrix));
    Matrix4d m = identity_matrix;
    m[15] = -3;
    EXPECT_TRUE(is_affine(m));
    m[15] = 0;
    EXPECT_FALSE(is_affine(m));
    for (std::size_t i = 0; i < 16; ++i)
        for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
            m = identity_matrix;
            m[i] = bad;
            EXPECT_FALSE(is_finite(m)) << i;
            EXPECT_FALSE(is_affine(m)) << i;
        }
    for (const std::size_t i : {3u, 7u, 11u}) {
        m = identity_matrix;
        m[i] = 1e-300;
        EXPECT_FALSE(is_affine(m)) << i;
        EXPECT_TRUE(is_finite(m)) << i;
    }
}

}  // namespace
