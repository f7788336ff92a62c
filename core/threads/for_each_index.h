// Work on many items by several threads, in any order.
#pragma once

#include "pcm/system/error.h"
#include "pcm/threads/crew.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <type_traits>

namespace pcm {

// Whether the work on an item is no longer wanted, as the operation was cancelled or failed in another thread: for
// items that take long.
class Stop {
public:
    explicit Stop(const Signal& signal) : signal_(signal) {}
    bool asked() const { return signal_.stopped; }
    // Throws Error(cancelled) where it was asked for. The caller of for_each_index() gets what was thrown first.
    void check() const
    {
        if (asked()) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }

private:
    const Signal& signal_;
};

// Calls work(i), or work(i, stop) where it takes a const Stop&, once for each i = 0 .. count - 1, on `threads` threads.
// `tick(begun)` is called on the calling thread a few times a second, with the number of items begun. The first
// exception of either asks the work to stop and is thrown.
template <class Work, class Tick>
void for_each_index(std::size_t count, unsigned threads, const Work& work, const Tick& tick)
{
    std::atomic<std::size_t> next{0};
    Signal signal;
    const Stop stop(signal);
    Crew crew(signal);
    const std::size_t most = std::clamp<std::size_t>(count, 1, std::max(1u, threads));
    for (std::size_t t = 0; t < most; ++t)
        crew.add([&] {
            for (std::size_t i; !stop.asked() && (i = next++) < count;)
                if constexpr (std::is_invocable_v<const Work&, std::size_t, const Stop&>)
                    work(i, stop);
                else
                    work(i);
        });
    crew.join([&] { tick(std::min(next.load(), count)); });
}

}  // namespace pcm
