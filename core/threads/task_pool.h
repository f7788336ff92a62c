// Tasks that run on a pool of threads, or on the thread that needs the result first.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace pcm {

// Work that runs at most once: on a thread of the pool or on the thread that needs it, whichever comes first. Any
// thread may call, but the work itself must not call its own task.
class Task {
public:
    explicit Task(std::function<void()> work) : work_(std::move(work)) {}
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

    // Runs the work unless it has begun or was cancelled. What it throws is kept for finish().
    void run_if_waiting();
    // Runs the work here unless it has begun; else waits for its end. Throws what the work threw. After a cancel()
    // before the start it returns without effect.
    void finish();
    // The work is not started any more; waits for its end if it is running.
    void cancel();
    // Whether the work has ended or was cancelled.
    bool done() const;

private:
    enum class State { waiting, running, done };
    mutable std::mutex mutex_;
    std::condition_variable ended_;
    State state_ = State::waiting;
    std::exception_ptr error_;
    std::function<void()> work_;
};

// Threads start when they are first needed. Any thread may call.
class TaskPool {
public:
    TaskPool() = default;
    // Waits for running tasks. Waiting ones are dropped: finish() still runs them, on its caller's thread.
    ~TaskPool();
    TaskPool(const TaskPool&) = delete;
    TaskPool& operator=(const TaskPool&) = delete;

    static constexpr unsigned most_threads = 64;
    // Tasks are started in the order of their submission, on up to `threads` threads (at most most_threads); an earlier
    // call may have started more. Where the system gives no further thread, the pool works with fewer or none:
    // finish() runs what has not begun.
    void submit(std::shared_ptr<Task> task, unsigned threads);

private:
    void work();
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::shared_ptr<Task>> tasks_;
    std::vector<std::thread> threads_;
    bool closing_ = false;
};

// A value that a task makes. Moved, not copied. One thread at a time calls. The destructor cancels the task and waits
// for it if it is running: what make() uses has to live that long.
template <class T>
class Pending {
public:
    Pending() = default;
    template <class Make>
    Pending(TaskPool& pool, unsigned threads, Make make) : value_(std::make_shared<std::optional<T>>())
    {
        task_ = std::make_shared<Task>([value = value_, make = std::move(make)] { *value = make(); });
        pool.submit(task_, threads);
    }
    Pending(Pending&& other) noexcept = default;
    Pending& operator=(Pending&& other) noexcept
    {
        drop();
        value_ = std::move(other.value_);
        task_ = std::move(other.task_);
        return *this;
    }
    ~Pending() { drop(); }

    bool valid() const { return task_ != nullptr; }
    bool done() const { return task_->done(); }
    // The value, made on this thread if no other has begun; once. Throws what make() threw.
    T get()
    {
        const std::shared_ptr<Task> task = std::move(task_);
        const std::shared_ptr<std::optional<T>> value = std::move(value_);
        task->finish();
        return std::move(**value);
    }

private:
    void drop()
    {
        if (task_) task_->cancel();
        task_.reset();
    }
    std::shared_ptr<std::optional<T>> value_;  // written by the task, read after its end
    std::shared_ptr<Task> task_;
};

}  // namespace pcm
