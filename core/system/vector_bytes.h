// The size of the widest vectors of the instructions that a source is compiled for: for sources that are compiled once
// per level of system/cpu.h. A constant of each source alone, and no function.
#pragma once

#include <cstddef>

namespace pcm {

#if defined(__AVX512F__)
constexpr std::size_t vector_bytes = 64;
#elif defined(__AVX2__)
constexpr std::size_t vector_bytes = 32;
#else
constexpr std::size_t vector_bytes = 16;
#endif

}  // namespace pcm
