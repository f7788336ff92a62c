// How many points a chunk of a tree has at most unless there is a reason for another number: the largest size that the
// caches' study (bench/results) found as good as the best. Larger ones show a coarser picture while a view moves and
// take longer to load, smaller ones make a cold scan slower.
#pragma once

#include <cstdint>

namespace pcm {

inline constexpr std::uint32_t default_chunk_points = 25'000;

// The range that builds and updates accept.
inline constexpr std::uint32_t least_chunk_points = 1'000, most_chunk_points = 10'000'000;

}  // namespace pcm
