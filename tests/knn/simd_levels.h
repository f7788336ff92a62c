// Tests at each level of system/cpu.h that the processor runs.
#pragma once

#include "pcm/system/cpu.h"

#include <gtest/gtest.h>
#include <cstdlib>
#include <string>

namespace pcm {

// The level as long as the object lives.
class LevelInForce {
public:
    explicit LevelInForce(SimdLevel level) { setenv("PCM_SIMD", std::string(name_of(level)).c_str(), 1); }
    ~LevelInForce() { unsetenv("PCM_SIMD"); }
};

template <class Test>
void at_each_level(const Test& test)
{
    for (const SimdLevel level : simd_levels()) {
        SCOPED_TRACE(std::string(name_of(level)));
        const LevelInForce in_force(level);
        test();
        if (testing::Test::HasFatalFailure()) return;
    }
}

}  // namespace pcm
