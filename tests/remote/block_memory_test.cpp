#include "pcm/remote/block_memory.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace {

using namespace pcm;

RemoteBlock block_of(std::uint64_t number)
{
    return std::make_shared<const std::vector<std::byte>>(1, static_cast<std::byte>(number));
}

// Fetches, and counts what was fetched.
struct Fetcher {
    std::atomic<int> blocks{0}, calls{0};
    BlockMemory::Fetch fetch = [this](const std::vector<std::uint64_t>& numbers) {
        ++calls;
        BlockMemory::Fetched fetched;
        for (const std::uint64_t number : numbers) fetched.emplace_back(number, block_of(number));
        blocks += static_cast<int>(numbers.size());
        return fetched;
    };
};

TEST(BlockMemoryTest, WhatIsThereIsNotFetchedAgain)
{
    BlockMemory memory(8);
    Fetcher fetcher;
    const int file = 0;
    memory.get(&file, 2, 2, fetcher.fetch);
    const auto blocks = memory.get(&file, 0, 6, fetcher.fetch);
    ASSERT_EQ(blocks.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(blocks[i]->front(), static_cast<std::byte>(i));
    EXPECT_EQ(fetcher.blocks, 6);
    EXPECT_EQ(fetcher.calls, 2);
}

TEST(BlockMemoryTest, FilesHaveBlocksOfTheirOwn)
{
    BlockMemory memory(8);
    Fetcher fetcher;
    const int files[2] = {};
    memory.get(&files[0], 0, 1, fetcher.fetch);
    memory.get(&files[1], 0, 1, fetcher.fetch);
    EXPECT_EQ(fetcher.blocks, 2);
    memory.forget(&files[0]);
    memory.get(&files[1], 0, 1, fetcher.fetch);
    EXPECT_EQ(fetcher.blocks, 2);
    memory.get(&files[0], 0, 1, fetcher.fetch);
    EXPECT_EQ(fetcher.blocks, 3);
}

TEST(BlockMemoryTest, TheBlocksUsedLastStay)
{
    BlockMemory memory(2);
    Fetcher fetcher;
    const int file = 0;
    for (const std::uint64_t number : {0u, 1u, 0u, 2u, 0u}) memory.get(&file, number, 1, fetcher.fetch);
    EXPECT_EQ(fetcher.blocks, 3);  // block 0 stayed, as it was used between
    memory.get(&file, 1, 1, fetcher.fetch);
    EXPECT_EQ(fetcher.blocks, 4);
    // More at once than stay.
    EXPECT_EQ(memory.get(&file, 10, 5, fetcher.fetch).size(), 5u);
}

TEST(BlockMemoryTest, AFailureIsOfItsCallerAndOthersTryAgain)
{
    BlockMemory memory(8);
    const int file = 0;
    std::atomic<int> failures{0}, calls{0};
    const BlockMemory::Fetch fetch = [&](const std::vector<std::uint64_t>& numbers) {
        BlockMemory::Numbers claimed = numbers;
        memory.claim(&file, 2, 5, claimed);
        if (++calls <= 3) throw std::runtime_error("no");
        BlockMemory::Fetched fetched;
        for (const std::uint64_t number : claimed) fetched.emplace_back(number, block_of(number));
        return fetched;
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&] {
            try {
                EXPECT_EQ(memory.get(&file, 0, 2, fetch).size(), 2u);
            } catch (const std::runtime_error&) {
                ++failures;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(failures, 3);
    // What the failed ones had claimed beyond what was wanted is nobody's, and what the last one had is in memory.
    EXPECT_EQ(calls, 4);
    EXPECT_EQ(memory.get(&file, 0, 5, fetch)[4]->front(), std::byte{4});
    EXPECT_EQ(calls, 4);
}

TEST(BlockMemoryTest, ManyThreadsFetchEachBlockOnce)
{
    BlockMemory memory(64);
    Fetcher fetcher;
    const int file = 0;
    std::vector<std::thread> threads;
    for (std::uint64_t i = 0; i < 8; ++i)
        threads.emplace_back([&, i] {
            for (std::uint64_t first = 0; first < 56; ++first) {
                const auto blocks = memory.get(&file, (first * (i + 1)) % 56, 5, fetcher.fetch);
                EXPECT_EQ(blocks[4]->front(), static_cast<std::byte>((first * (i + 1)) % 56 + 4));
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(fetcher.blocks, 60);
}

}  // namespace
