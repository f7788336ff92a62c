// Threads that work together, and the watch the user keeps on them.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/progress.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace pcm {

// Passes progress on to the user, at most ten times a second, and turns a wish to cancel into an exception.
class Watch {
public:
    explicit Watch(const ProgressFunction& progress)
        : progress_(progress), start_(std::chrono::steady_clock::now()), last_(start_)
    {
    }

    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

    // On the calling thread only; throws Error(cancelled). `at_once`: however little time has passed.
    void report(std::string_view stage, double fraction, bool at_once = false)
    {
        if (!progress_) return;
        const auto now = std::chrono::steady_clock::now();
        if (!at_once && fraction < 1 && now - last_ < std::chrono::milliseconds(100)) return;
        last_ = now;
        fraction_ = std::clamp(fraction, fraction_, 1.0);
        ProgressUpdate update;
        update.stage = stage;
        update.fraction = fraction_;
        if (fraction_ > 0.02) update.seconds_left = seconds() * (1 - fraction_) / fraction_;
        if (!progress_(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }

private:
    const ProgressFunction& progress_;
    std::chrono::steady_clock::time_point start_, last_;
    double fraction_ = 0;
};

// What threads that work together wait on, and whether they are to stop.
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

// Threads that stop together: the first exception of any is thrown by join(). Declare it after all that the threads
// use: when it dies they have ended.
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
    // Waits for all threads, calling `tick` a few times a second on this thread.
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
