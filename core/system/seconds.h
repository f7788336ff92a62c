// Seconds of wall time.
#pragma once

#include <algorithm>
#include <chrono>

namespace pcm {

inline double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The shorter of two waits, seconds; 0 is none.
inline double sooner(double wait, double other)
{
    return wait > 0 && other > 0 ? std::min(wait, other) : std::max(wait, other);
}

}  // namespace pcm
