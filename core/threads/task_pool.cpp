#include "pcm/threads/task_pool.h"

#include <algorithm>
#include <system_error>

namespace pcm {

void Task::run_if_waiting()
{
    {
        const std::lock_guard lock(mutex_);
        if (state_ != State::waiting) return;
        state_ = State::running;
    }
    std::exception_ptr error;
    try {
        work_();
    } catch (...) {
        error = std::current_exception();
    }
    work_ = nullptr;  // what it holds is freed now, not when the pool comes to it
    {
        const std::lock_guard lock(mutex_);
        error_ = std::move(error);
        state_ = State::done;
    }
    ended_.notify_all();
}

void Task::finish()
{
    run_if_waiting();
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return state_ == State::done; });
    if (error_) std::rethrow_exception(error_);
}

void Task::cancel()
{
    std::function<void()> dropped;  // freed after the lock, and not when the pool comes to it
    std::unique_lock lock(mutex_);
    if (state_ == State::waiting) {
        state_ = State::done;
        dropped.swap(work_);
    }
    ended_.wait(lock, [this] { return state_ == State::done; });
}

bool Task::done() const
{
    const std::lock_guard lock(mutex_);
    return state_ == State::done;
}

TaskPool::~TaskPool()
{
    {
        const std::lock_guard lock(mutex_);
        closing_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void TaskPool::submit(std::shared_ptr<Task> task, unsigned threads)
{
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
        try {
            while (threads_.size() < std::clamp(threads, 1u, most_threads)) threads_.emplace_back([this] { work(); });
        } catch (const std::system_error&) {  // too many threads in this process or system
        }
    }
    wake_.notify_one();
}

void TaskPool::work()
{
    for (;;) {
        std::shared_ptr<Task> task;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return closing_ || !tasks_.empty(); });
            if (closing_) return;
            task = std::move(tasks_.front());
            tasks_.pop_front();
        }
        task->run_if_waiting();
    }
}

}  // namespace pcm
