// Work on many items by several threads, whose results are taken one by one in the order of the items.
#pragma once

#include "pcm/threads/crew.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <utility>

namespace pcm {

// Results that threads finish in any order and that are taken in the order of their numbers. A mutex of the caller's
// guards it: all member functions but the constructor are called with the mutex held.
template <class Result>
class OrderedResults {
public:
    explicit OrderedResults(std::size_t first = 0) : next_(first) {}

    std::size_t next() const { return next_; }  // the first that has not been taken

    // Adds a result, then calls take(number, result) for every result that is next in order, with `lock` released. One
    // thread at a time does so. When take() throws, no result is taken any more.
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
    std::map<std::size_t, Result> waiting_;  // finished before an earlier one
    std::size_t next_;
    bool taking_ = false;
};

// Calls make(i) for i = 0 .. count - 1 on `threads` threads, and take(i, result) in the order of i, on any of the
// threads, one at a time. At most 2 * threads results wait, so memory stays bounded. `tick(done)` is called on the
// calling thread a few times a second, with the number of results taken. The first exception of any of the three ends
// the work and is thrown.
template <class Make, class Take, class Tick>
void in_turn(std::size_t count, unsigned threads, const Make& make, const Take& take, const Tick& tick)
{
    using Result = decltype(make(std::size_t{}));
    threads = static_cast<unsigned>(std::clamp<std::size_t>(count, 1, std::max(1u, threads)));
    Signal signal;
    OrderedResults<Result> results;
    std::size_t next = 0;
    const auto work = [&] {
        std::unique_lock lock(signal.mutex);
        for (;;) {
            signal.wake.wait(lock,
                             [&] { return signal.stopped || next == count || next < results.next() + 2 * threads; });
            if (signal.stopped || next == count) return;
            const std::size_t mine = next++;
            lock.unlock();
            Result result = make(mine);
            lock.lock();
            results.add(lock, mine, std::move(result), take);
            signal.wake.notify_all();
        }
    };
    Crew crew(signal);
    for (unsigned t = 0; t < threads; ++t) crew.add(work);
    crew.join([&] {
        std::size_t done;
        {
            const std::lock_guard lock(signal.mutex);
            done = results.next();
        }
        tick(done);
    });
}

}  // namespace pcm
