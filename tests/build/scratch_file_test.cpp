// Scratch files: their growth, their holes, and the disk space that all of them are counted with.
#include "pcm/build/bins/scratch_file.h"

#include "tests/support.h"

#include <sys/stat.h>

#include <algorithm>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

std::uint64_t on_disk(const std::filesystem::path& path)
{
    struct stat status {};
    EXPECT_EQ(::stat(path.c_str(), &status), 0);
    return static_cast<std::uint64_t>(status.st_blocks) * 512;
}

TEST(ScratchSpace, ThePeakIsTheMostAtOnce)
{
    ScratchSpace space;
    EXPECT_EQ(space.peak(), 0u);
    std::mt19937 random(1);
    std::uint64_t now = 0, peak = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::uint64_t bytes = random() % 1000;
        if (random() % 2) {
            space.take(bytes);
            peak = std::max(peak, now += bytes);
        } else {
            space.give_back(std::min(now, bytes));
            now -= std::min(now, bytes);
        }
        ASSERT_EQ(space.peak(), peak);
    }
}

TEST(ScratchSpace, ThreadsLoseNothing)
{
    ScratchSpace space;
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 20000; ++i) space.take(3);
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(space.peak(), 240000u);
}

TEST(ScratchFile, GrowsAtItsEndAndCountsWhatIsOnDisk)
{
    TemporaryFolder folder;
    ScratchSpace space;
    const std::size_t page = ScratchFile::page;
    const std::string data(page, 'a');
    {
        ScratchFile file(folder / "s", space);
        EXPECT_EQ(file.path(), folder / "s");
        EXPECT_EQ(file.reserve(3 * page), 0u);
        EXPECT_EQ(file.reserve(page), 3 * page);
        EXPECT_EQ(file.bytes(), 4 * page);
        EXPECT_EQ(space.peak(), 0u) << "nothing is on disk";
        for (std::size_t k = 0; k < 4; ++k) file.write_at(data.data(), page, k * page);
        file.take(4 * page);
        EXPECT_EQ(space.peak(), 4 * page);
        file.sync();
        ASSERT_EQ(on_disk(folder / "s"), 4 * page);
        file.give_back(page, 0, 0);
        EXPECT_EQ(on_disk(folder / "s"), 4 * page);
        file.give_back(page, 2 * page, 2 * page);
        EXPECT_EQ(on_disk(folder / "s"), 2 * page) << "holes";
        EXPECT_EQ(std::filesystem::file_size(folder / "s"), 4 * page) << "its size stays";
        std::string read(2 * page, '?');
        file.read_at(read.data(), read.size(), 2 * page);
        EXPECT_EQ(read, std::string(page, '\0') + data);
        space.take(page);  // another file's
        EXPECT_EQ(space.peak(), 4 * page) << "two were given back";
        space.take(page + 1);
        EXPECT_EQ(space.peak(), 4 * page + 1);
        space.give_back(2 * page + 1);
    }
    // Its space is no longer counted, but it is on disk still.
    space.take(4 * page);
    EXPECT_EQ(space.peak(), 4 * page + 1);
    space.give_back(4 * page);
    {
        ScratchFile again(folder / "s", space, true);
        EXPECT_EQ(again.bytes(), 4 * page) << "grows at the old end";
        space.take(2 * page + 2);
        EXPECT_EQ(space.peak(), 4 * page + 2) << "what it has on disk counts";
        space.give_back(2 * page + 2);
        again.clear();
        EXPECT_EQ(std::filesystem::file_size(folder / "s"), 0u);
        space.take(4 * page + 2);
        EXPECT_EQ(space.peak(), 4 * page + 2) << "an empty file has nothing on disk";
        space.give_back(4 * page + 2);
        again.take(page);
        again.remove();
        EXPECT_FALSE(std::filesystem::exists(folder / "s"));
        space.take(4 * page + 2);
        EXPECT_EQ(space.peak(), 4 * page + 2) << "nor has one that is removed";
    }
}

TEST(ScratchFile, ANewOneReplacesTheOld)
{
    TemporaryFolder folder;
    ScratchSpace space;
    for (const bool again : {false, true}) {
        ScratchFile file(folder / "s", space);
        EXPECT_EQ(file.bytes(), 0u) << again;
        file.write_at("abc", 3, file.reserve(3));
    }
    const Error error = scratch_changed("/tmp/s", 1234);
    EXPECT_EQ(error.code(), ErrorCode::corrupt);
    EXPECT_NE(std::string(error.what()).find("/tmp/s: the data at byte 1234 have changed since they were written"),
              std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("build again"), std::string::npos);
}

}  // namespace
