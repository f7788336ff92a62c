#include "pcm/threads/for_each_index.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace pcm {
namespace {

TEST(ForEachIndex, CallsTheWorkOnceForEachIndex)
{
    for (const unsigned threads : {0u, 1u, 3u}) {
        std::vector<std::atomic<int>> calls(200);
        for_each_index(
            calls.size(), threads, [&](std::size_t i) { ++calls[i]; }, [](std::size_t) {});
        for (const auto& count : calls) EXPECT_EQ(count, 1);
    }
    for_each_index(
        0, 2, [](std::size_t) { FAIL(); }, [](std::size_t) {});
}

// Work that would never end by itself ends when the operation is cancelled, and the caller gets the wish to cancel.
TEST(ForEachIndex, LongWorkIsAskedToStop)
{
    std::atomic<int> ended{0};
    const auto work = [&](std::size_t, const Stop& stop) {
        try {
            for (;;) {
                stop.check();
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        } catch (const Error& error) {
            ended += error.code() == ErrorCode::cancelled;
            throw;
        }
    };
    const auto cancel = [](std::size_t) { throw std::runtime_error("the user has cancelled"); };
    try {
        for_each_index(100, 3, work, cancel);
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "the user has cancelled");
    }
    EXPECT_EQ(ended, 3);
}

// The failure of one item stops the others, and is what the caller gets.
TEST(ForEachIndex, TheFirstFailureStopsAndIsThrown)
{
    std::atomic<bool> waiting{false};
    const auto work = [&](std::size_t i, const Stop& stop) {
        if (i == 0) {
            while (!waiting) std::this_thread::yield();
            throw std::runtime_error("item 0");
        }
        waiting = true;
        while (!stop.asked()) std::this_thread::yield();
        stop.check();
    };
    try {
        for_each_index(2, 2, work, [](std::size_t) {});
        FAIL();
    } catch (const std::exception& error) {
        EXPECT_STREQ(error.what(), "item 0");
    }
}

}  // namespace
}  // namespace pcm
