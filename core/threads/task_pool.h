// Threads that read ahead for those who stream.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace pcm {

// Work that is done once, by a thread of the pool or by the one that needs it, whichever comes first.
class ReadTask {
public:
    explicit ReadTask(std::function<void()> work) : work_(std::move(work)) {}

    void run_if_waiting();
    // Does it if nobody has begun, else waits for it.
    void finish();
    // It is not begun any more; waits if it is running.
    void cancel();

private:
    enum class State { waiting, running, done };
    std::mutex mutex_;
    std::condition_variable done_;
    State state_ = State::waiting;
    std::function<void()> work_;  // throws nothing
};

// Threads start when they are first needed. Any thread may ask.
class ReadPool {
public:
    ReadPool() = default;
    ~ReadPool();
    ReadPool(const ReadPool&) = delete;
    ReadPool& operator=(const ReadPool&) = delete;

    static constexpr unsigned most_threads = 64;
    // In the order asked, on at least `threads` threads (at most most_threads).
    void ask(std::shared_ptr<ReadTask> task, unsigned threads);

private:
    void work();
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::shared_ptr<ReadTask>> tasks_;
    std::vector<std::thread> threads_;
    bool closing_ = false;
};

}  // namespace pcm
