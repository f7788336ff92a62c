#include "pcm/threads/brief_mutex.h"

#include <gtest/gtest.h>

#include <mutex>
#include <vector>

namespace {

using pcm::BriefMutex;

TEST(BriefMutex, OneThreadAtATimeHasIt)
{
    BriefMutex mutex;
    std::uint64_t low = 0, high = 0;  // equal whenever the mutex is free
    constexpr std::uint64_t each = 20000;
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (std::uint64_t i = 0; i < each; ++i) {
                const std::lock_guard lock(mutex);
                ASSERT_EQ(low, high);
                ++low;
                if (i % 1000 == 0) std::this_thread::yield();
                ++high;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(low, 4 * each);
    EXPECT_EQ(high, 4 * each);
}

TEST(BriefMutex, TryLockFailsWhileAnotherHasIt)
{
    BriefMutex mutex;
    ASSERT_TRUE(mutex.try_lock());
    std::thread([&] { EXPECT_FALSE(mutex.try_lock()); }).join();
    mutex.unlock();
    EXPECT_TRUE(mutex.try_lock());
    mutex.unlock();
}

TEST(BriefMutex, AWaitingThreadSleepsUntilItIsFree)
{
    BriefMutex mutex;
    mutex.lock();
    std::atomic<bool> got{false};
    std::thread other([&] {
        const std::lock_guard lock(mutex);
        got = true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(got);
    mutex.unlock();
    other.join();
    EXPECT_TRUE(got);
}

}  // namespace
