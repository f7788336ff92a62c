// Results that threads finish in any order and that are taken one by one in theirs.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <utility>

namespace pcm {

// Guarded by a mutex of the threads': all but the constructor is called with it held.
template <class Result>
class Turns {
public:
    explicit Turns(std::size_t first = 0) : next_(first) {}

    std::size_t next() const { return next_; }  // the first that has not been taken

    // Of what has come by now, calls take(number, result) for all whose turn it is, with `lock` released; one thread at
    // a time does so. When take() throws, nothing is taken any more.
    template <class Take>
    void add(std::unique_lock<std::mutex>& lock, std::size_t number, Result result, const Take& take)
    {
        waiting_.emplace(number, std::move(result));
        while (!taking_ && !waiting_.empty() && waiting_.begin()->first == next_) {
            taking_ = true;
            Result first = std::move(waiting_.begin()->second);
            waiting_.erase(waiting_.begin());
            lock.unlock();
            take(next_, std::move(first));
            lock.lock();
            taking_ = false;
            ++next_;
        }
    }

private:
    std::map<std::size_t, Result> waiting_;  // finished ahead of their turn
    std::size_t next_;
    bool taking_ = false;
};

}  // namespace pcm
