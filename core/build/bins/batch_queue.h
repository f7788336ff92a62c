// Batches of points between the thread that reads and the threads that convert.
#pragma once

#include "pcm/threads/crew.h"

#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace pcm {

// Holds `capacity` batches, whose storage is reused. Any thread.
template <class Batch>
class BatchQueue {
public:
    BatchQueue(Signal& signal, std::size_t capacity) : signal_(signal), free_(capacity) {}

    // The reader's side: an empty batch, or nothing when all threads are to stop.
    std::optional<Batch> empty_batch()
    {
        std::unique_lock lock(signal_.mutex);
        signal_.wake.wait(lock, [&] { return !free_.empty() || signal_.stopped; });
        if (signal_.stopped) return std::nullopt;
        Batch batch = std::move(free_.back());
        free_.pop_back();
        return batch;
    }
    void push(Batch batch)
    {
        {
            const std::lock_guard lock(signal_.mutex);
            full_.push_back(std::move(batch));
        }
        signal_.wake.notify_all();
    }
    void close()
    {
        {
            const std::lock_guard lock(signal_.mutex);
            closed_ = true;
        }
        signal_.wake.notify_all();
    }
    std::optional<Batch> pop()
    {
        std::unique_lock lock(signal_.mutex);
        signal_.wake.wait(lock, [&] { return !full_.empty() || closed_ || signal_.stopped; });
        if (signal_.stopped || full_.empty()) return std::nullopt;
        Batch batch = std::move(full_.front());
        full_.pop_front();
        return batch;
    }
    void recycle(Batch batch)
    {
        {
            const std::lock_guard lock(signal_.mutex);
            free_.push_back(std::move(batch));
        }
        signal_.wake.notify_all();
    }

private:
    Signal& signal_;
    std::vector<Batch> free_;
    std::deque<Batch> full_;
    bool closed_ = false;
};

}  // namespace pcm
