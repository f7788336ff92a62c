// Work on many things side by side, with results taken one by one in their order.
#pragma once

#include "pcm/threads/crew.h"
#include "pcm/threads/turns.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <utility>

namespace pcm {

// Calls make(i) for i = 0 .. count - 1 on `threads` threads, and take(i, result) for one after the other, on any of
// them, one at a time. At most 2 * threads results wait, so memory stays bounded. `tick(done)` is called on the calling
// thread a few times a second. The first exception of any ends all and is thrown.
template <class Make, class Take, class Tick>
void in_turn(std::size_t count, unsigned threads, const Make& make, const Take& take, const Tick& tick)
{
    using Result = decltype(make(std::size_t{}));
    threads = std::max(1u, threads);
    Signal signal;
    Turns<Result> turns;
    std::size_t next = 0;
    const auto work = [&] {
        std::unique_lock lock(signal.mutex);
        for (;;) {
            signal.wake.wait(lock,
                             [&] { return signal.stopped || next == count || next < turns.next() + 2 * threads; });
            if (signal.stopped || next == count) return;
            const std::size_t mine = next++;
            lock.unlock();
            Result result = make(mine);
            lock.lock();
            turns.add(lock, mine, std::move(result), take);
            signal.wake.notify_all();
        }
    };
    Crew crew(signal);
    for (unsigned t = 0; t < threads; ++t) crew.add(work);
    crew.join([&] {
        std::size_t done;
        {
            const std::lock_guard lock(signal.mutex);
            done = turns.next();
        }
        tick(done);
    });
}

}  // namespace pcm
