// Which vector instructions this processor runs. Hot loops are compiled once per level, and the best one is chosen
// here.
#pragma once

#include <string_view>
#include <vector>

namespace pcm {

// Each level includes those before it. CMake gives a source file its instructions: PCM_AVX2_OPTIONS and
// PCM_AVX512_OPTIONS in core/CMakeLists.txt. Such a file must not instantiate inline functions that other files use
// too (no standard containers): the linker keeps one copy, which may then hold instructions that the processor lacks.
enum class SimdLevel {
    baseline,  // SSE2, which every x86-64 has; plain C++ on other processors
    avx2,      // AVX2, BMI1, BMI2, FMA, LZCNT, POPCNT
    avx512,    // and AVX-512 F, BW, CD, DQ, VL
};

// "baseline", "avx2" or "avx512".
std::string_view name_of(SimdLevel level);

// The highest level of this processor.
SimdLevel processor_simd_level();

// The level to use: the processor's, or a lower one that the environment variable PCM_SIMD names (for tests and
// benchmarks; a higher one changes nothing). Throws Error(invalid_argument) if it names no level. Reads the environment
// at each call: to be called once per task, not in loops.
SimdLevel simd_level();

// All levels that this processor runs, ascending.
std::vector<SimdLevel> simd_levels();

}  // namespace pcm
