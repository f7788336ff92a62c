// The default for the largest number of points in a chunk of a tree: the largest size that was as good as the best in
// the study of the caches (bench/results). With larger chunks a moving view shows a coarser picture and chunks take
// longer to load; smaller chunks make a cold scan slower.
#pragma once

#include <cstdint>

namespace pcm {

inline constexpr std::uint32_t default_chunk_points = 25'000;

// The range that builds and updates accept.
inline constexpr std::uint32_t least_chunk_points = 1'000, most_chunk_points = 10'000'000;

}  // namespace pcm
