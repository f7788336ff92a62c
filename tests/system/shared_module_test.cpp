#include "pcm/system/shared_module.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pcm {
namespace {

TEST(SharedModule, AnAbsentOneIsNamed)
{
    const SharedModule module = load_shared_module("libpcm_no_such_thing.so", "pcm_functions", 1);
    EXPECT_EQ(module.functions, nullptr);
    EXPECT_NE(module.missing.find("libpcm_no_such_thing.so"), std::string::npos) << module.missing;
}

// The C library stands for a module of an older version: it is found where the system looks, without the symbol.
TEST(SharedModule, OneWithoutTheSymbolIsRefused)
{
    const SharedModule module = load_shared_module("libm.so.6", "pcm_functions", 1);
    EXPECT_EQ(module.functions, nullptr);
    EXPECT_EQ(module.missing, "libm.so.6 belongs to another version of this library");
}

#ifdef PCM_TEST_MODULE
TEST(SharedModule, BesideTheProgramAndOfTheSameVersion)
{
    const SharedModule module = load_shared_module("libpcm_test_module.so", "pcm_test_functions", 7);
    ASSERT_NE(module.functions, nullptr) << module.missing;
    EXPECT_EQ(module.missing, "");
    EXPECT_EQ(*static_cast<const std::uint32_t*>(module.functions), 7u);
}

// By its name alone, a program knows no folder of its own: this one, run again as a shell finds it.
TEST(SharedModule, BesideAProgramThatIsFoundOnThePath)
{
    const std::filesystem::path here = std::filesystem::canonical("/proc/self/exe");
    const std::string command = "cd / && PATH='" + here.parent_path().string() + "' exec " + here.filename().string() +
                                " --gtest_filter=SharedModule.BesideTheProgramAndOfTheSameVersion > /dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

TEST(SharedModule, AnotherVersionIsRefusedWithItsPath)
{
    const SharedModule module = load_shared_module("libpcm_test_module.so", "pcm_test_functions", 8);
    EXPECT_EQ(module.functions, nullptr);
    EXPECT_NE(module.missing.find("bin/libpcm_test_module.so belongs to another version"), std::string::npos)
        << module.missing;
}
#endif

}  // namespace
}  // namespace pcm
