#include "pcm/system/round_number.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using pcm::round_number;

TEST(RoundNumber, IsTheNearestByRatio)
{
    EXPECT_EQ(round_number(12.54138708114624), 10);
    EXPECT_EQ(round_number(0.25), 0.2);
    EXPECT_EQ(round_number(0.33), 0.5);
    EXPECT_EQ(round_number(4), 5);
    EXPECT_EQ(round_number(8), 10);
    EXPECT_EQ(round_number(999), 1000);
    for (const double exact : {0.001, 0.002, 0.005, 1.0, 2.0, 5.0, 1e12, 5e-12}) EXPECT_EQ(round_number(exact), exact);
    for (double value = 1e-9; value < 1e9; value *= 1.0371) {
        const double round = round_number(value), digit = round / std::pow(10, std::floor(std::log10(round) + 1e-9));
        EXPECT_LE(std::fabs(std::log(round / value)), std::log(2.5) / 2 + 1e-12) << value;
        EXPECT_TRUE(std::fabs(digit - 1) < 1e-9 || std::fabs(digit - 2) < 1e-9 || std::fabs(digit - 5) < 1e-9) << round;
    }
}

TEST(RoundNumber, WhatHasNoneStays)
{
    EXPECT_EQ(round_number(0), 0);
    EXPECT_EQ(round_number(-3), -3);
    EXPECT_EQ(round_number(HUGE_VAL), HUGE_VAL);
    EXPECT_TRUE(std::isnan(round_number(std::nan(""))));
}

}  // namespace
