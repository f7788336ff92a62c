// What an operation reports of itself, checked from outside.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/progress.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>

namespace pcm::test {

// From its construction on.
class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Expects that an operation that began after the stopwatch took some time, and no more than has passed.
inline void expect_time(double seconds, const Stopwatch& watch)
{
    EXPECT_GT(seconds, 0);
    EXPECT_LE(seconds, watch.seconds());
}

// The same, with the numbers of points; an error has a meaning.
inline void expect_outcome(const Outcome& outcome, std::uint64_t points_in, std::uint64_t points_out,
                           const Stopwatch& watch)
{
    EXPECT_EQ(outcome.points_in, points_in);
    EXPECT_EQ(outcome.points_out, points_out);
    expect_time(outcome.seconds, watch);
    EXPECT_TRUE(outcome.error >= 0 && std::isfinite(outcome.error)) << outcome.error;
    if (outcome.error > 0) EXPECT_FALSE(outcome.error_meaning.empty());
    EXPECT_TRUE(outcome.warnings.empty());
}

// Runs `action`, which must throw pcm::Error, and returns it.
inline Error error_of(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no pcm::Error was thrown";
    return Error(ErrorCode::io, {}, "none");
}

}  // namespace pcm::test
