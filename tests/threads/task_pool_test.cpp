#include "pcm/threads/task_pool.h"

#include "tests/failing_threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <numeric>
#include <stdexcept>

namespace {

using namespace pcm;

// Holds the threads that come to it until it is opened.
class Gate {
public:
    void wait() { future_.wait(); }
    void open() { promise_.set_value(); }

private:
    std::promise<void> promise_;
    std::shared_future<void> future_ = promise_.get_future().share();
};

std::shared_ptr<Task> task(std::function<void()> work) { return std::make_shared<Task>(std::move(work)); }

// A thread that is blocked in a call is not seen to return within this time.
constexpr std::chrono::milliseconds moment(30);

TEST(Task, RunsOnceHoweverManyThreadsFinishIt)
{
    for (int round = 0; round < 200; ++round) {
        std::atomic<int> runs{0};
        const auto once = task([&] { ++runs; });
        TaskPool pool;
        pool.submit(once, 2);
        std::vector<std::future<void>> others;
        for (int t = 0; t < 3; ++t)
            others.push_back(std::async(std::launch::async, [&] {
                once->finish();
                EXPECT_EQ(runs, 1);
            }));
        for (auto& other : others) other.get();
        EXPECT_TRUE(once->done());
    }
}

TEST(Task, FinishRunsWaitingWorkOnItsOwnThread)
{
    std::thread::id ran_on;
    const auto waiting = task([&] { ran_on = std::this_thread::get_id(); });
    EXPECT_FALSE(waiting->done());
    waiting->finish();
    EXPECT_EQ(ran_on, std::this_thread::get_id());
    EXPECT_TRUE(waiting->done());
}

TEST(Task, FinishAndCancelWaitForRunningWork)
{
    for (const bool cancel : {false, true}) {
        Gate begun, go;
        bool ended = false;
        TaskPool pool;
        const auto running = task([&] {
            begun.open();
            go.wait();
            ended = true;
        });
        pool.submit(running, 1);
        begun.wait();
        auto waiter = std::async(std::launch::async, [&] {
            cancel ? running->cancel() : running->finish();
            return ended;
        });
        EXPECT_EQ(waiter.wait_for(moment), std::future_status::timeout);
        EXPECT_FALSE(running->done());
        go.open();
        EXPECT_TRUE(waiter.get());
        EXPECT_TRUE(running->done());
    }
}

TEST(Task, CancelledBeforeTheStartItNeverRuns)
{
    bool ran = false;
    const auto held = std::make_shared<int>(1);
    const auto cancelled = task([&ran, held] { ran = true; });
    TaskPool pool;
    cancelled->cancel();
    EXPECT_EQ(held.use_count(), 1) << "what the work held is still there";
    EXPECT_TRUE(cancelled->done());
    pool.submit(cancelled, 1);
    cancelled->finish();
    cancelled->cancel();
    const auto after = task([] {});
    pool.submit(after, 1);  // behind the cancelled one in the queue
    while (!after->done()) std::this_thread::yield();
    EXPECT_FALSE(ran);
}

TEST(Task, WhatTheWorkThrowsComesOutOfFinish)
{
    TaskPool pool;
    const auto thrown = task([] { throw std::runtime_error("broken"); });
    pool.submit(thrown, 1);
    while (!thrown->done()) std::this_thread::yield();
    for (int i = 0; i < 2; ++i) EXPECT_THROW(thrown->finish(), std::runtime_error);
    EXPECT_NO_THROW(thrown->cancel());
    const auto next = task([] {});
    pool.submit(next, 1);
    while (!next->done()) std::this_thread::yield();  // the pool's thread lives
}

TEST(TaskPool, StartsTasksInTheOrderOfSubmission)
{
    std::vector<int> order;
    std::vector<std::shared_ptr<Task>> tasks;
    TaskPool pool;
    for (int i = 0; i < 100; ++i) {
        tasks.push_back(task([&order, i] { order.push_back(i); }));
        pool.submit(tasks.back(), 1);
    }
    while (!tasks.back()->done()) std::this_thread::yield();
    std::vector<int> all(100);
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
}

TEST(TaskPool, RunsOnAsManyThreadsAsAskedFor)
{
    std::atomic<int> running{0};
    Gate all;
    TaskPool pool;
    std::vector<std::shared_ptr<Task>> tasks;
    for (int t = 0; t < 4; ++t) {
        tasks.push_back(task([&] {
            if (++running == 4) all.open();
            all.wait();
        }));
        pool.submit(tasks.back(), 4);
    }
    while (!tasks.back()->done()) std::this_thread::yield();  // hangs if fewer threads run them
    EXPECT_EQ(running, 4);
}

TEST(TaskPool, ItsEndWaitsForRunningTasksAndDropsWaitingOnes)
{
    Gate begun, go;
    std::atomic<bool> ended{false}, dropped_ran{false};
    const auto running = task([&] {
        begun.open();
        go.wait();
        ended = true;
    });
    const auto waiting = task([&] { dropped_ran = true; });
    std::future<void> opener;
    {
        TaskPool pool;
        pool.submit(running, 1);
        pool.submit(waiting, 1);
        begun.wait();
        opener = std::async(std::launch::async, [&] {
            std::this_thread::sleep_for(moment);  // the pool is in its destructor by then
            go.open();
        });
    }
    EXPECT_TRUE(ended);
    EXPECT_FALSE(dropped_ran);
    waiting->finish();
    EXPECT_TRUE(dropped_ran);
}

TEST(TaskPool, WithoutAnyThreadFinishDoesTheWork)
{
    std::thread::id ran_on;
    const auto alone = task([&] { ran_on = std::this_thread::get_id(); });
    TaskPool pool;
    {
        const test::FailingThreads none(0);
        EXPECT_NO_THROW(pool.submit(alone, 4));
        alone->finish();
    }
    EXPECT_EQ(ran_on, std::this_thread::get_id());
    const auto later = task([] {});
    pool.submit(later, 2);  // there are threads again
    while (!later->done()) std::this_thread::yield();
}

TEST(Pending, GivesTheValueOrTheError)
{
    TaskPool pool;
    std::vector<Pending<std::unique_ptr<int>>> ahead;
    for (int i = 0; i < 50; ++i) ahead.emplace_back(pool, 3, [i] { return std::make_unique<int>(i * i); });
    for (int i = 0; i < 50; ++i) EXPECT_EQ(*ahead[static_cast<std::size_t>(i)].get(), i * i);
    EXPECT_FALSE(ahead[0].valid());

    Pending<int> broken(pool, 1, []() -> int { throw std::runtime_error("broken"); });
    EXPECT_TRUE(broken.valid());
    EXPECT_THROW(broken.get(), std::runtime_error);
    EXPECT_FALSE(broken.valid());
}

TEST(Pending, DroppingItWaitsForWorkThatRuns)
{
    Gate begun, go;
    std::atomic<bool> ended{false};
    TaskPool pool;
    Pending<int> value(pool, 1, [&] {
        begun.open();
        go.wait();
        ended = true;
        return 1;
    });
    begun.wait();
    EXPECT_FALSE(value.done());
    auto dropped = std::async(std::launch::async, [&] {
        value = Pending<int>();
        return ended.load();
    });
    EXPECT_EQ(dropped.wait_for(moment), std::future_status::timeout);
    go.open();
    EXPECT_TRUE(dropped.get());

    bool ran = false;
    {
        TaskPool idle;
        const test::FailingThreads none(0);
        const Pending<int> never(idle, 1, [&] { return ran = true, 1; });
    }
    EXPECT_FALSE(ran);
}

}  // namespace
