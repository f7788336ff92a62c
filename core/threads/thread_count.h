// How many threads an operation uses.
#pragma once

#include <algorithm>
#include <thread>

namespace pcm {

// `asked` threads; 0 asks for one per processor. Never 0, also where the system does not know its processors.
inline unsigned thread_count(unsigned asked)
{
    return asked ? asked : std::max(1u, std::thread::hardware_concurrency());
}

}  // namespace pcm
