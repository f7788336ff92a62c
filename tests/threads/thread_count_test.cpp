#include "pcm/threads/thread_count.h"

#include <gtest/gtest.h>

namespace {

using pcm::thread_count;

TEST(ThreadCount, ZeroIsOnePerProcessorAndNeverZero)
{
    EXPECT_EQ(thread_count(1), 1u);
    EXPECT_EQ(thread_count(77), 77u);
    EXPECT_GE(thread_count(0), 1u);
    if (const unsigned processors = std::thread::hardware_concurrency()) {
        EXPECT_EQ(thread_count(0), processors);
    }
}

}  // namespace
