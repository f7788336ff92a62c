#include "pcm/threads/crew.h"

#include "tests/failing_threads.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>
#include <system_error>

namespace {

using namespace pcm;

// Waits until the crew stops.
void wait_for_stop(Signal& signal)
{
    std::unique_lock lock(signal.mutex);
    signal.wake.wait(lock, [&] { return signal.stopped.load(); });
}

TEST(Crew, EveryThreadRunsItsWork)
{
    Signal signal;
    std::set<std::thread::id> ids;
    Crew crew(signal);
    for (int t = 0; t < 7; ++t)
        crew.add([&] {
            std::unique_lock lock(signal.mutex);
            ids.insert(std::this_thread::get_id());
            signal.wake.notify_all();
            signal.wake.wait(lock, [&] { return ids.size() == 7; });  // all of them at the same time
        });
    crew.join([] {});
    EXPECT_EQ(ids.size(), 7u);
    EXPECT_EQ(ids.count(std::this_thread::get_id()), 0u);
    EXPECT_FALSE(signal.stopped);
}

TEST(Crew, TheFirstExceptionStopsTheOthersAndIsThrown)
{
    Signal signal;
    Crew crew(signal);
    for (int t = 0; t < 3; ++t) crew.add([&] { wait_for_stop(signal); });
    crew.add([] { throw std::runtime_error("first"); });
    crew.add([&] {
        wait_for_stop(signal);
        throw std::runtime_error("second");
    });
    try {
        crew.join([] {});
        FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "first");
    }
    EXPECT_TRUE(signal.stopped);
}

TEST(Crew, TickRunsOnTheCallersThreadAndItsExceptionEndsTheCrew)
{
    Signal signal;
    int ticks = 0;
    std::atomic<int> ended{0};
    {
        Crew crew(signal);
        for (int t = 0; t < 3; ++t)
            crew.add([&] {
                wait_for_stop(signal);
                ++ended;
            });
        const auto here = std::this_thread::get_id();
        EXPECT_THROW(crew.join([&] {
            EXPECT_EQ(std::this_thread::get_id(), here);
            if (++ticks == 2) throw std::runtime_error("cancelled");
        }),
                     std::runtime_error);
        EXPECT_EQ(ended, 0);
    }
    EXPECT_EQ(ticks, 2);
    EXPECT_EQ(ended, 3);
}

TEST(Crew, AThreadThatCannotStartEndsThoseThatRun)
{
    Signal signal;
    std::atomic<int> ended{0};
    {
        Crew crew(signal);
        crew.add([&] {
            wait_for_stop(signal);
            ++ended;
        });
        const test::FailingThreads none(0);
        EXPECT_THROW(crew.add([] {}), std::system_error);
    }
    EXPECT_EQ(ended, 1);
}

}  // namespace
