#pragma once

#include <cstdint>

namespace pcm {

// How many grid steps `high` lies above `low`, which is not above it; also where the difference exceeds an int64.
inline std::uint64_t grid_steps(std::int64_t low, std::int64_t high)
{
    return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
}

}  // namespace pcm
