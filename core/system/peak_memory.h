#pragma once

#include <cstdint>

namespace pcm {

// The largest resident memory of this process since its start, in bytes.
std::uint64_t peak_memory_bytes();

}  // namespace pcm
