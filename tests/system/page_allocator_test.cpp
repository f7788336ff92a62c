#include "pcm/system/page_allocator.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <thread>
#include <vector>

namespace {

using namespace pcm;

constexpr std::size_t mebibyte = std::size_t(1) << 20;
constexpr std::size_t most_kept = 32 * mebibyte;  // freed blocks that are kept
constexpr std::size_t slack = 2 * mebibyte;       // what the C library maps meanwhile for the test's own lists

// Bytes of the process's address space.
std::size_t mapped_bytes()
{
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * 4096;
}

struct Block {
    unsigned char* data;
    std::size_t bytes;
    unsigned char mark;

    explicit Block(std::size_t size, unsigned char mark_of_block)
        : data(static_cast<unsigned char*>(take_pages(size))), bytes(size), mark(mark_of_block)
    {
        data[0] = data[bytes / 2] = data[bytes - 1] = mark;
    }
    bool is_whole() const { return data[0] == mark && data[bytes / 2] == mark && data[bytes - 1] == mark; }
};

// Under a sanitizer the blocks are the C library's.
bool has_pool()
{
    const Block block(mebibyte, 1);
    const bool found = pages_in_use() > 0;
    give_pages(block.data, block.bytes);
    return found;
}

#define SKIP_WITHOUT_A_POOL() \
    if (!has_pool()) GTEST_SKIP() << "a sanitizer: the C library's heap is used"

TEST(PageAllocator, BlocksAreApartAlignedAndAsLargeAsRequested)
{
    std::mt19937 random(7);
    const std::size_t before = pages_in_use();
    const bool whole_pages = has_pool();
    std::map<unsigned char*, Block> live;
    for (int i = 0; i < 3000; ++i) {
        if (live.size() < 20 || random() % 2) {
            const std::size_t bytes =
                page_block_bytes + random() % (random() % 4 ? 8 * page_block_bytes : 4 * mebibyte);
            const Block block(bytes, static_cast<unsigned char>(random()));
            const auto [place, fresh] = live.emplace(block.data, block);
            ASSERT_TRUE(fresh);
            const auto next = std::next(place);
            if (next != live.end()) {
                ASSERT_LE(block.data + bytes, next->first);
            }
            if (place != live.begin()) {
                const Block& last = std::prev(place)->second;
                ASSERT_LE(last.data + last.bytes, block.data);
            }
            if (whole_pages) {
                ASSERT_EQ(reinterpret_cast<std::uintptr_t>(block.data) % 4096, 0u);
            }
        } else {
            const auto place = std::next(live.begin(), static_cast<std::ptrdiff_t>(random() % live.size()));
            ASSERT_TRUE(place->second.is_whole());
            give_pages(place->first, place->second.bytes);
            live.erase(place);
        }
    }
    for (const auto& [data, block] : live) {
        EXPECT_TRUE(block.is_whole());
        give_pages(data, block.bytes);
    }
    EXPECT_EQ(pages_in_use(), before);
}

TEST(PageAllocator, BytesInUseAreThoseOfTheBlocksAndAnEighthMoreAtMost)
{
    SKIP_WITHOUT_A_POOL();
    const std::size_t before = pages_in_use();
    for (std::size_t bytes = page_block_bytes; bytes < 20 * mebibyte; bytes += bytes / 13 + 1) {
        void* const block = take_pages(bytes);
        const std::size_t used = pages_in_use() - before;
        EXPECT_GE(used, bytes);
        EXPECT_LE(used, bytes + bytes / 8 + page_block_bytes / 8) << bytes;
        give_pages(block, bytes);
        EXPECT_EQ(pages_in_use(), before);
    }
}

// Whether a block is one that was given back: new pages are 0.
bool is_taken_again(std::size_t bytes)
{
    const Block block(bytes, 77);
    give_pages(block.data, bytes);
    auto* const next = static_cast<unsigned char*>(take_pages(bytes));
    const bool again = next[0] == 77 && next[bytes - 1] == 77;
    next[0] = next[bytes - 1] = 0;
    give_pages(next, bytes);
    return again;
}

TEST(PageAllocator, AFreedBlockIsTakenAgain)
{
    SKIP_WITHOUT_A_POOL();
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(is_taken_again(3 * mebibyte)) << i;  // 300 MB, one after the other
    const Block block(3 * mebibyte, 5);
    give_pages(block.data, block.bytes);
    auto* const smaller = static_cast<unsigned char*>(take_pages(3 * mebibyte - 100));  // in the same class of sizes
    EXPECT_EQ(smaller[0], 5);
    give_pages(smaller, 3 * mebibyte - 100);
}

// Blocks of one size are kept, then those of other sizes are needed: the system gets back the former.
TEST(PageAllocator, NoMoreThanAFewFreedBlocksStayMapped)
{
    SKIP_WITHOUT_A_POOL();
    std::vector<Block> blocks;
    blocks.reserve(1000);
    const std::size_t mapped = mapped_bytes(), used = pages_in_use();
    for (const std::size_t bytes : {mebibyte, 2 * mebibyte, mebibyte / 2, 5 * mebibyte, 40 * mebibyte, mebibyte}) {
        for (std::size_t sum = 0; sum < 100 * mebibyte; sum += bytes) blocks.emplace_back(bytes, 3);
        EXPECT_GE(mapped_bytes() + most_kept + slack, mapped + 100 * mebibyte);
        for (const Block& block : blocks) give_pages(block.data, block.bytes);
        blocks.clear();
        EXPECT_EQ(pages_in_use(), used);
        EXPECT_LE(mapped_bytes(), mapped + most_kept + slack) << "after blocks of " << bytes << " bytes";
    }
}

// A block too large to be kept ends one that is kept, every time.
TEST(PageAllocator, BlocksThatMakeRoomAreUnmapped)
{
    SKIP_WITHOUT_A_POOL();
    const std::size_t mapped = mapped_bytes();
    for (int round = 0; round < 150; ++round) {
        std::vector<Block> blocks;
        for (int i = 0; i < 32; ++i) blocks.emplace_back(mebibyte, 3);
        for (const Block& block : blocks) give_pages(block.data, block.bytes);
        give_pages(take_pages(40 * mebibyte), 40 * mebibyte);
    }
    EXPECT_LE(mapped_bytes(), mapped + most_kept + slack);
}

// What is kept is of the sizes that are used now.
TEST(PageAllocator, BlocksOfTheSizeInUseDisplaceOthersThatAreKept)
{
    SKIP_WITHOUT_A_POOL();
    std::vector<Block> blocks;
    for (int i = 0; i < 40; ++i) blocks.emplace_back(mebibyte, 3);
    for (const Block& block : blocks) give_pages(block.data, block.bytes);
    int given = 0;
    while (given < 8 && !is_taken_again(6 * mebibyte)) ++given;  // each may end one of those that are kept
    EXPECT_LE(given, 6);
}

TEST(PageAllocator, AnImpossibleSizeIsRefusedAndNotCounted)
{
    SKIP_WITHOUT_A_POOL();  // AddressSanitizer ends the process at such a size
    const std::size_t before = pages_in_use();
    EXPECT_THROW(PageVector<std::uint64_t>(static_cast<std::size_t>(-1) / 32), std::bad_alloc);
    EXPECT_THROW(PageAllocator<std::uint64_t>().allocate(static_cast<std::size_t>(-1) / 8), std::bad_alloc);
    EXPECT_EQ(pages_in_use(), before);
}

TEST(PageAllocator, SmallBlocksAreTheHeapsAndLargeOnesPages)
{
    SKIP_WITHOUT_A_POOL();
    const std::size_t before = pages_in_use();
    {
        const PageVector<std::uint16_t> small(page_block_bytes / 2 - 1), large(page_block_bytes / 2);
        EXPECT_EQ(pages_in_use(), before + page_block_bytes);
    }
    EXPECT_EQ(pages_in_use(), before);
}

// Taken on one thread and given back on another.
TEST(PageAllocator, ThreadsDoNotShareBlocks)
{
    const std::size_t before = pages_in_use();
    std::vector<Block> given;
    for (int round = 0; round < 20; ++round) {
        std::vector<std::vector<Block>> taken(4);
        std::vector<std::thread> threads;
        for (std::size_t t = 0; t < taken.size(); ++t)
            threads.emplace_back([&, t] {
                for (std::size_t i = t; i < given.size(); i += taken.size()) give_pages(given[i].data, given[i].bytes);
                for (std::size_t i = 0; i < 10; ++i)
                    taken[t].emplace_back(page_block_bytes * (1 + i % 3), static_cast<unsigned char>(10 * t + i));
            });
        for (std::thread& thread : threads) thread.join();
        given.clear();
        for (const std::vector<Block>& blocks : taken) given.insert(given.end(), blocks.begin(), blocks.end());
        for (const Block& block : given) ASSERT_TRUE(block.is_whole());
    }
    for (const Block& block : given) give_pages(block.data, block.bytes);
    EXPECT_EQ(pages_in_use(), before);
}

}  // namespace
