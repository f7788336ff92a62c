// A module of version 7, for tests/system/shared_module_test.cpp.
#include <cstdint>

extern "C" __attribute__((visibility("default"))) const void* pcm_test_functions()
{
    static constexpr std::uint32_t version = 7;
    return &version;
}
