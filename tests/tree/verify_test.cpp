// Verifying trees, whole and damaged ones.

#include "pcm/tree/verify.h"

#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "tests/failing_threads.h"
#include "tests/tree/small_tree.h"

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <random>
#include <stdexcept>
#include <system_error>

namespace {

std::atomic<std::size_t> largest_allocation{std::numeric_limits<std::size_t>::max()};

}  // namespace

// Memory that can run short. All forms that the library uses: std::stable_sort asks for its buffer without exceptions.
[[gnu::noinline]] void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept
{
    return bytes <= largest_allocation ? std::malloc(bytes) : nullptr;
}
[[gnu::noinline]] void* operator new(std::size_t bytes)
{
    void* const memory = operator new(bytes, std::nothrow);
    if (!memory) throw std::bad_alloc();
    return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

using VerifyTest = SmallTree;

// Whatever byte of whatever file changes, verify notices.
TEST_F(VerifyTest, VerifyNoticesAnyDamage)
{
    build();
    EXPECT_TRUE(verify_tree(tree()).faults.empty());
    std::mt19937_64 random(5);
    for (const char* name : {index_file_name, "chunks-000.bpc"}) {
        const std::vector<std::byte> good = read_file(tree() / name);
        for (int round = 0; round < 150; ++round) {
            std::vector<std::byte> bad = good;
            const std::size_t at = random() % bad.size();
            bad[at] ^= static_cast<std::byte>(1 + random() % 255);
            write_file(tree() / name, bad);
            bool noticed = false;
            try {
                const VerifyReport report = verify_tree(tree());
                noticed = !report.faults.empty();
                if (noticed) EXPECT_NE(report.faults[0].find(name), std::string::npos) << report.faults[0];
            } catch (const Error&) {
                noticed = true;
            }
            EXPECT_TRUE(noticed) << "byte " << at << " of " << name;
        }
        write_file(tree() / name, good);
    }
}

// Two chunks swapped in the index: both are undamaged, but belong to the other node.
TEST_F(VerifyTest, VerifyNoticesSwappedChunks)
{
    build();
    TreeIndex index = this->index();
    std::swap(index.nodes[1].extent, index.nodes[2].extent);
    write_index(index);
    EXPECT_FALSE(verify_tree(tree()).faults.empty());
}

TEST_F(VerifyTest, VerifyLooksAroundTheIndex)
{
    build(3000, 1000);
    const auto names = [](const std::vector<std::string>& lines, const std::string& what) {
        return lines.size() == 1 && lines[0].find(what) != std::string::npos;
    };
    VerifyReport report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.faults.empty() && report.around.empty() && report.notes.empty());

    TreeInfo info = index().info;
    info.sources.push_back("another.las");
    write_about(tree(), info);
    EXPECT_TRUE(names(verify_tree(tree(), 1).around, "differs from the index"));
    info.generation = 2;
    write_about(tree(), info);
    report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.around.empty());
    EXPECT_TRUE(names(report.notes, "interrupted"));
    info.generation = 3;
    write_about(tree(), info);
    EXPECT_TRUE(names(verify_tree(tree(), 1).around, "generation 3"));
    fs::remove(tree() / about_file_name);
    EXPECT_TRUE(names(verify_tree(tree(), 1).around, about_file_name));
    write_about(tree(), index().info);

    write_file(tree() / "chunks-007.bpc", {});
    EXPECT_TRUE(names(verify_tree(tree(), 1).notes, "chunks-007.bpc"));
    fs::remove(tree() / "chunks-007.bpc");

    const auto good = read_file(tree() / data_file_name(0));
    auto longer = good;
    longer.resize(longer.size() + 3);
    write_file(tree() / data_file_name(0), longer);
    EXPECT_TRUE(names(verify_tree(tree(), 1).notes, "3 bytes after"));
    auto damaged = good;
    damaged[damaged.size() - 20] ^= std::byte(1);  // in the record at its end
    write_file(tree() / data_file_name(0), damaged);
    report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.faults.empty());
    EXPECT_TRUE(names(report.notes, "commit record"));
    write_file(tree() / data_file_name(0), good);
    report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.faults.empty() && report.around.empty() && report.notes.empty());
}

// A chunk as a faulty program would write it: all checksums match, but a box, a path or a generation is wrong.
TEST_F(VerifyTest, VerifyFindsWhatChecksumsCannot)
{
    build(20000, 20000);
    const TreeIndex index = this->index();
    const Extent extent = index.nodes[0].extent;
    const auto good = read_file(tree() / data_file_name(extent.file));
    const BpcHeader header = decode_header(good.data() + extent.offset, static_cast<std::size_t>(extent.bytes), {});
    ASSERT_GT(header.segments.size(), 2u);
    const auto changed = [&](std::size_t at, unsigned change) {
        auto bytes = good;
        std::byte* chunk = bytes.data() + extent.offset;
        chunk[at] ^= static_cast<std::byte>(change);
        const std::uint64_t sum = checksum(chunk, header.header_bytes - 8);
        std::memcpy(chunk + header.header_bytes - 8, &sum, 8);
        write_file(tree() / data_file_name(extent.file), bytes);
        return verify_tree(tree(), 1).faults;
    };
    for (const std::size_t at :
         {std::size_t(144), std::size_t(148), std::size_t(152), std::size_t(160)})  // part, generation, spacing, level
        EXPECT_FALSE(changed(at, 2).empty()) << at;
    // Boxes of segments: lower a smallest corner that stays inside the chunk's box.
    const std::size_t boxes = 164 + 4 * header.identity->level_points.size();
    std::size_t tried = 0;
    for (std::size_t s = 0; s < header.segments.size(); ++s) {
        const std::uint32_t low = static_cast<std::uint32_t>(header.segments[s].box.min[0] - header.box.min[0]);
        if (!(low & 1)) continue;
        const auto faults = changed(boxes + 24 * s, 1);
        ASSERT_EQ(faults.size(), 1u);
        EXPECT_NE(faults[0].find("not tight"), std::string::npos) << faults[0];
        ++tried;
    }
    EXPECT_GT(tried, 0u);
}

TEST_F(VerifyTest, CanBeCancelled)
{
    build();
    int calls = 0;
    try {
        verify_tree(tree(), 2, [&](const ProgressUpdate&) {
            ++calls;
            return false;
        });
        ADD_FAILURE() << "verified";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    EXPECT_EQ(calls, 1);
}

TEST_F(VerifyTest, WhatTheProgressFunctionThrowsReachesTheCaller)
{
    build();
    const auto progress = [](const ProgressUpdate&) -> bool { throw std::runtime_error("enough"); };
    EXPECT_THROW(verify_tree(tree(), 2, progress), std::runtime_error);
}

TEST_F(VerifyTest, AThreadThatCannotBeStartedIsAnErrorAndNoDamage)
{
    build();
    for (int allowed = 0; allowed < 4; ++allowed) {
        const FailingThreads failing(allowed);
        EXPECT_THROW(verify_tree(tree(), 4), std::system_error) << allowed;
        EXPECT_EQ(failing.refused(), 1);
    }
    EXPECT_TRUE(verify_tree(tree(), 4).faults.empty());
}

TEST_F(VerifyTest, TooLittleMemoryIsAnErrorAndNoDamage)
{
    build(20000, 20000);
    largest_allocation = 200'000;  // opening takes less, the rows of a chunk more
    EXPECT_THROW(verify_tree(tree(), 2), std::bad_alloc);
    largest_allocation = std::numeric_limits<std::size_t>::max();
    EXPECT_TRUE(verify_tree(tree(), 2).faults.empty());
}

}  // namespace
