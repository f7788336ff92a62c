#include "pcm/threads/task_pool.h"

#include <algorithm>

namespace pcm {

void ReadTask::run_if_waiting()
{
    {
        const std::lock_guard lock(mutex_);
        if (state_ != State::waiting) return;
        state_ = State::running;
    }
    work_();
    {
        const std::lock_guard lock(mutex_);
        state_ = State::done;
    }
    done_.notify_all();
}

void ReadTask::finish()
{
    run_if_waiting();
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return state_ == State::done; });
}

void ReadTask::cancel()
{
    std::unique_lock lock(mutex_);
    if (state_ == State::waiting) state_ = State::done;
    done_.wait(lock, [this] { return state_ == State::done; });
}

ReadPool::~ReadPool()
{
    {
        const std::lock_guard lock(mutex_);
        closing_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void ReadPool::ask(std::shared_ptr<ReadTask> task, unsigned threads)
{
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
        while (threads_.size() < std::clamp(threads, 1u, most_threads)) threads_.emplace_back([this] { work(); });
    }
    wake_.notify_one();
}

void ReadPool::work()
{
    for (;;) {
        std::shared_ptr<ReadTask> task;
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
