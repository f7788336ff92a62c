#include "pcm/system/free_memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <vector>

namespace {

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

std::uint64_t resident_bytes()
{
    std::uint64_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

// One block of a thousand is still in use, so that the heap cannot shrink.
TEST(FreeMemory, BetweenBlocksThatAreInUseGoesBackToTheSystem)
{
    std::vector<std::unique_ptr<std::vector<char>>> blocks(100000);
    for (auto& block : blocks) block = std::make_unique<std::vector<char>>(1000, 'x');
    const std::uint64_t full = resident_bytes();
    for (std::size_t i = 0; i < blocks.size(); ++i)
        if (i % 1000 != 999) blocks[i].reset();
    EXPECT_GT(resident_bytes(), full - 50'000'000);  // else there is nothing to test
    pcm::return_free_memory();
    EXPECT_LT(resident_bytes(), full - 80'000'000);
    for (std::size_t i = 999; i < blocks.size(); i += 1000) EXPECT_EQ(blocks[i]->at(999), 'x');
}

#endif

}  // namespace
