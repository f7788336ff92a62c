// Work on many items by several threads, in any order.
#pragma once

#include "pcm/threads/crew.h"

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace pcm {

// Calls work(i) once for each i = 0 .. count - 1, on `threads` threads. `tick(begun)` is called on the calling thread a
// few times a second, with the number of items begun. The first exception of either ends the work and is thrown.
template <class Work, class Tick>
void for_each_index(std::size_t count, unsigned threads, const Work& work, const Tick& tick)
{
    std::atomic<std::size_t> next{0};
    Signal signal;
    Crew crew(signal);
    const std::size_t most = std::clamp<std::size_t>(count, 1, std::max(1u, threads));
    for (std::size_t t = 0; t < most; ++t)
        crew.add([&] {
            for (std::size_t i; !signal.stopped && (i = next++) < count;) work(i);
        });
    crew.join([&] { tick(std::min(next.load(), count)); });
}

}  // namespace pcm
