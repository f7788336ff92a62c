#include "pcm/tree/point_size.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace pcm;

TEST(PointSize, EveryCodeIsTheCodeOfItsSize)
{
    for (const double least : {1e-300, 1e-12, 0.00123, 1.0, 7e9, 1e280}) {
        EXPECT_EQ(point_size(1, least), least);
        for (int code = 1; code < 256; ++code) {
            const auto c = static_cast<std::uint8_t>(code);
            const double size = point_size(c, least);
            EXPECT_EQ(size_code(size, least), c) << least;
            // The smallest that is not below: a little more is the next one, a little less the same one.
            EXPECT_EQ(size_code(size * 1.0001, least), std::min(255, code + 1)) << least;
            EXPECT_EQ(size_code(size * 0.9999, least), c) << least;
        }
        // Quarter octaves.
        EXPECT_DOUBLE_EQ(point_size(5, least), 2 * least);
        EXPECT_DOUBLE_EQ(point_size(41, least), 1024 * least);
    }
}

TEST(PointSize, CodesAscendAndStayInTheirRange)
{
    int before = 1;
    for (double size = 1e-3; size < 1e25; size *= 1.01) {
        const int code = size_code(size, 1);
        EXPECT_GE(code, before);
        EXPECT_LE(code, before + 1);
        if (code < 255) EXPECT_GE(point_size(static_cast<std::uint8_t>(code), 1), size * (1 - 1e-8));
        before = code;
    }
    EXPECT_EQ(before, 255);
    for (const double small : {0.0, -1.0, 1e-300, 1.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_EQ(size_code(small, 1), 1) << small;  // 0 is kept for sizes that are not known
    EXPECT_EQ(size_code(std::numeric_limits<double>::infinity(), 1), 255);
}

TEST(PointSize, TheLeastIsHalfOfTheCellsDiagonal)
{
    EXPECT_DOUBLE_EQ(least_point_size({{2, 3, 6}, {5, 5, 5}}), 3.5);
    EXPECT_DOUBLE_EQ(least_point_size({{1e-300, 1e-300, 1e-300}, {0, 0, 0}}), std::sqrt(0.75) * 1e-300);
    EXPECT_DOUBLE_EQ(least_point_size({{1e300, 1e300, 1e300}, {0, 0, 0}}), std::sqrt(0.75) * 1e300);
}
