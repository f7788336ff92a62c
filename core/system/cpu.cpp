#include "pcm/system/cpu.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#endif

namespace pcm {
namespace {

constexpr const char* variable = "PCM_SIMD";

#if defined(__x86_64__) && defined(__GNUC__)
// Clang's __builtin_cpu_supports() does not know it.
bool has_lzcnt()
{
    constexpr unsigned leaf = 0x80000001, bit = 1u << 5;
    unsigned a = 0, b = 0, c = 0, d = 0;
    return __get_cpuid(leaf, &a, &b, &c, &d) != 0 && (c & bit) != 0;
}
#endif

SimdLevel detect()
{
#if defined(__x86_64__) && defined(__GNUC__)
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
                      __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("popcnt") && has_lzcnt();
    if (!avx2) return SimdLevel::baseline;
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512vl");
    return avx512 ? SimdLevel::avx512 : SimdLevel::avx2;
#else
    return SimdLevel::baseline;
#endif
}

}  // namespace

std::string_view name_of(SimdLevel level)
{
    switch (level) {
        case SimdLevel::avx2:
            return "avx2";
        case SimdLevel::avx512:
            return "avx512";
        default:
            return "baseline";
    }
}

SimdLevel processor_simd_level()
{
    static const SimdLevel level = detect();
    return level;
}

SimdLevel simd_level()
{
    const char* asked = std::getenv(variable);
    if (!asked || !*asked) return processor_simd_level();
    for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512})
        if (asked == name_of(level)) return std::min(level, processor_simd_level());
    throw Error(ErrorCode::invalid_argument, {},
                "the environment variable " + std::string(variable) + " is \"" + asked + "\"",
                "set it to baseline, avx2 or avx512, or unset it");
}

std::vector<SimdLevel> simd_levels()
{
    std::vector<SimdLevel> levels;
    for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512})
        if (level <= processor_simd_level()) levels.push_back(level);
    return levels;
}

}  // namespace pcm
