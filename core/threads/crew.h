// Threads that work together on one operation.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace pcm {

// What the threads of an operation wait on, and whether they are to stop. `stopped` may be read without the mutex; it
// is set with the mutex held, so that a thread that waits for `wake` with a test of `stopped` never misses it.
struct Signal {
    std::mutex mutex;
    std::condition_variable wake;
    std::atomic<bool> stopped{false};

    void stop()
    {
        {
            const std::lock_guard lock(mutex);
            stopped = true;
        }
        wake.notify_all();
    }
};

// Threads that stop together: the first exception of any of them sets `stopped` and is thrown by join(). The work has
// to test `stopped` often. Declare the crew after everything that its threads use: its destructor stops and joins them.
// One thread owns the crew and calls it.
class Crew {
public:
    explicit Crew(Signal& signal) : signal_(signal) {}
    ~Crew()
    {
        signal_.stop();
        for (std::thread& thread : threads_) thread.join();
    }
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;

    // Starts a thread that runs work(). Throws std::system_error when the system gives no thread; those that run are
    // stopped and joined by the destructor.
    template <class F>
    void add(F work)
    {
        threads_.emplace_back([this, work = std::move(work)]() mutable {
            std::exception_ptr error;
            try {
                work();
            } catch (...) {
                error = std::current_exception();
            }
            {
                const std::lock_guard lock(signal_.mutex);
                ++finished_;
                if (error) {
                    if (!error_) error_ = error;
                    signal_.stopped = true;
                }
            }
            signal_.wake.notify_all();
        });
    }
    // Waits for all threads, calling tick() a few times a second on this thread; what tick() throws comes out at once,
    // and the destructor ends the threads.
    template <class F>
    void join(F&& tick)
    {
        for (;;) {
            {
                std::unique_lock lock(signal_.mutex);
                const auto all = [&] { return finished_ == threads_.size(); };
                if (signal_.wake.wait_for(lock, std::chrono::milliseconds(100), all)) break;
            }
            tick();
        }
        for (std::thread& thread : threads_) thread.join();
        threads_.clear();
        if (error_) std::rethrow_exception(error_);
    }

private:
    Signal& signal_;
    std::vector<std::thread> threads_;
    std::size_t finished_ = 0;
    std::exception_ptr error_;
};

}  // namespace pcm
