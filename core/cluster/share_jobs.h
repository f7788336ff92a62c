// Jobs that the ranks of a team take from a shared counter.
#pragma once

#include "pcm/threads/crew.h"
#include "pcm/threads/team.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace pcm {

// Collective: calls work(i) once for each i = 0 .. count - 1, on one of the ranks, on `threads` threads of each, and
// returns when all are done. `counter`: one that nothing else uses. `tick(begun)` is called on the calling thread a few
// times a second, with about the number of jobs begun by all ranks.
template <class Work, class Tick>
void share_jobs(Team& team, std::uint64_t counter, std::size_t count, unsigned threads, const Work& work,
                const Tick& tick)
{
    std::atomic<std::uint64_t> begun{0};
    Signal signal;
    {
        Crew crew(signal);
        for (unsigned t = 0; t < threads; ++t)
            crew.add([&] {
                while (!signal.stopped) {
                    const std::uint64_t i = team.next(counter);
                    if (i >= count) return;
                    begun = std::max<std::uint64_t>(begun, i + 1);
                    work(static_cast<std::size_t>(i));
                }
            });
        crew.join([&] { tick(static_cast<std::size_t>(begun)); });
    }
    team.wait();
}

}  // namespace pcm
