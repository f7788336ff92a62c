#include "pcm/system/cpu.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>
#include <cstdlib>
#include <fstream>
#include <string>

namespace pcm {
namespace {

// The variable as long as the object lives; what it was afterwards.
class Environment {
public:
    explicit Environment(const char* value)
    {
        if (const char* old = std::getenv("PCM_SIMD")) old_ = old, had_ = true;
        setenv("PCM_SIMD", value, 1);
    }
    ~Environment() { had_ ? setenv("PCM_SIMD", old_.c_str(), 1) : unsetenv("PCM_SIMD"); }

private:
    std::string old_;
    bool had_ = false;
};

TEST(Cpu, TheEnvironmentChoosesALowerLevel)
{
    for (const SimdLevel level : simd_levels()) {
        const Environment environment(std::string(name_of(level)).c_str());
        EXPECT_EQ(simd_level(), level);
    }
    const Environment environment("");
    EXPECT_EQ(simd_level(), processor_simd_level());
}

TEST(Cpu, NoHigherLevelThanTheProcessors)
{
    const Environment environment("avx512");
    EXPECT_EQ(simd_level(), processor_simd_level());
    EXPECT_EQ(simd_levels().front(), SimdLevel::baseline);
    EXPECT_EQ(simd_levels().back(), processor_simd_level());
}

TEST(Cpu, AnUnknownLevelIsAnError)
{
    const Environment environment("sse9");
    try {
        simd_level();
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("PCM_SIMD is \"sse9\""), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("avx512"), std::string::npos) << error.what();
    }
}

// Against the kernel's list: a level that is not recognised would only cost time, and nobody would see it.
TEST(Cpu, TheLevelIsWhatTheKernelLists)
{
#if defined(__x86_64__)
    std::ifstream file("/proc/cpuinfo");
    std::string line;
    while (std::getline(file, line) && line.compare(0, 5, "flags") != 0) {
    }
    if (line.empty()) GTEST_SKIP() << "no flags in /proc/cpuinfo";
    line += ' ';
    const auto has = [&](const char* flag) { return line.find(std::string(" ") + flag + " ") != std::string::npos; };
    const bool avx2 = has("avx2") && has("bmi1") && has("bmi2") && has("fma") && has("abm") && has("popcnt");
    const bool avx512 =
        avx2 && has("avx512f") && has("avx512bw") && has("avx512cd") && has("avx512dq") && has("avx512vl");
    EXPECT_EQ(processor_simd_level(), avx512 ? SimdLevel::avx512 : (avx2 ? SimdLevel::avx2 : SimdLevel::baseline));
#else
    EXPECT_EQ(processor_simd_level(), SimdLevel::baseline);
#endif
}

}  // namespace
}  // namespace pcm
