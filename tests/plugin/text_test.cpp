#include "plugin/scene/text.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <new>
#include <string>

namespace pcm::host {
namespace {

TEST(Text, NumbersAreReadBackExactly)
{
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1234567), "1,234,567");
    for (const double value : {0.1, 4800000.123, -5e6 + 1e-9, 1e-9, 3e22, 0.0})
        EXPECT_EQ(std::stod(exact(value)), value);
    EXPECT_EQ(exact(4800000.123), "4800000.123");
}

TEST(Text, EveryErrorHasWords)
{
    const auto words = [](auto thrown) {
        try {
            throw thrown;
        } catch (...) {
            return current_error();
        }
    };
    EXPECT_EQ(words(Error(ErrorCode::io, "a/b", "went wrong")), "a/b: went wrong");
    EXPECT_EQ(words(std::bad_alloc()), "not enough memory");
    EXPECT_EQ(words(7), "an unknown error occurred");
}

}  // namespace
}  // namespace pcm::host
