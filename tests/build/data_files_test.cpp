// The data files of a tree that is being built: the top in front, chunks whole in one file, and what a checkpoint
// keeps.
#include "pcm/build/nodes/data_files.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_index.h"
#include "tests/support.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace {

thread_local std::vector<std::string>* synced_paths = nullptr;  // files that this thread has synced, where set

}  // namespace

// Takes the place of the system's.
extern "C" int fsync(int file)
{
    std::error_code ignored;
    if (synced_paths)
        synced_paths->push_back(std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file), ignored));
    return static_cast<int>(::syscall(SYS_fsync, file));
}

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr std::uint64_t file_limit = std::uint64_t(1) << 30;

std::string bytes_of(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

class DataFilesTest : public testing::Test {
protected:
    void SetUp() override
    {
        std::filesystem::create_directory(folder_ / "tree");
        std::filesystem::create_directory(folder_ / "work");
    }

    DataFiles files(std::uint32_t first) const { return DataFiles(folder_ / "tree", folder_ / "work", first); }
    std::filesystem::path path(std::uint32_t number) const { return folder_ / "tree" / data_file_name(number); }

    // A chunk of `bytes` equal bytes at a path of that depth, whose bits are `bits`.
    Draft& add(DataFiles& files, std::uint16_t depth, std::uint64_t bits, std::size_t bytes, char value)
    {
        Draft& draft = drafts_.emplace_back();
        draft.path.depth = depth;
        draft.path.bits = {bits, 0};
        draft.extent.bytes = bytes;
        values_.push_back(value);
        const std::string chunk(bytes, value);
        files.append(draft, reinterpret_cast<const std::byte*>(chunk.data()), bytes);
        return draft;
    }

    // Each chunk is where its draft says, and the files hold nothing else.
    void expect_chunks(const DataFiles& files, std::uint32_t first) const
    {
        std::vector<std::string> content;
        for (std::size_t n = 0; n < files.bytes().size(); ++n) {
            content.push_back(bytes_of(path(first + static_cast<std::uint32_t>(n))));
            EXPECT_EQ(content.back().size(), files.bytes()[n]);
        }
        std::size_t total = 0;
        for (std::size_t k = 0; k < drafts_.size(); ++k) {
            const Extent& extent = drafts_[k].extent;
            ASSERT_LT(extent.file - first, content.size());
            ASSERT_EQ(content[extent.file - first].substr(extent.offset, extent.bytes),
                      std::string(extent.bytes, values_[k]));
            total += extent.bytes;
        }
        for (const std::string& bytes : content) total -= bytes.size();
        EXPECT_EQ(total, 0u);
    }

    // What a checkpoint has of files of these sizes.
    static std::vector<std::byte> checkpoint(std::uint64_t front, const std::vector<std::uint64_t>& bytes)
    {
        ByteWriter out;
        out.put(front);
        out.put(static_cast<std::uint64_t>(bytes.size()));
        for (const std::uint64_t size : bytes) out.put(size);
        return out.bytes();
    }

    static void load(DataFiles& files, const std::vector<std::byte>& bytes)
    {
        const std::filesystem::path name = "checkpoint";
        ByteReader in(bytes.data(), bytes.size(), name);
        files.load(in);
        EXPECT_EQ(in.left(), 0u);
    }

    TemporaryFolder folder_;
    std::deque<Draft> drafts_;
    std::vector<char> values_;
};

TEST_F(DataFilesTest, TheTopIsInFrontParentsFirst)
{
    DataFiles files = this->files(3);
    std::mt19937 random(1);
    std::uint64_t appended = 0;
    for (char value = 'a'; value <= 'z'; ++value) {
        const auto depth = static_cast<std::uint16_t>(random() % 30);
        const std::size_t bytes = 1 + random() % 3000;
        add(files, depth, random() & ((std::uint64_t(1) << depth) - 1), bytes, value);
        appended += bytes;
        EXPECT_EQ(files.appended(), appended);
    }
    files.finish();
    expect_chunks(files, 3);
    std::vector<const Draft*> front;
    for (const Draft& draft : drafts_) {
        ASSERT_TRUE(draft.extent.file == 3 || draft.extent.file == 4);
        if (draft.extent.file == 3) front.push_back(&draft);
    }
    ASSERT_GT(front.size(), 3u);
    for (const Draft* a : front)
        for (const Draft& b : drafts_) {
            if (b.path.depth <= a->path.depth) EXPECT_EQ(b.extent.file, 3u) << "nothing above the front is elsewhere";
            if (b.extent.file == 3 &&
                (b.path.depth < a->path.depth || (b.path.depth == a->path.depth && b.path.bits < a->path.bits)))
                EXPECT_LT(b.extent.offset, a->extent.offset);
        }
}

// A file that is nearly full takes a chunk that fits to the byte; the next chunk begins another file.
TEST_F(DataFilesTest, NoChunkLiesAcrossTheLimitOfAFile)
{
    const std::uint64_t room = 500;
    std::ofstream(path(8)).close();
    std::filesystem::resize_file(path(8), file_limit - room);  // a hole: no byte of it is on disk
    DataFiles files = this->files(7);
    load(files, checkpoint(0, {0, file_limit - room}));
    const Draft& fits = add(files, 100, 0, room, 'a');
    EXPECT_EQ(fits.extent.file, 8u);
    EXPECT_EQ(fits.extent.offset, file_limit - room);
    EXPECT_EQ(std::filesystem::file_size(path(8)), file_limit);
    const Draft& next = add(files, 100, 1, 1, 'b');
    EXPECT_EQ(next.extent.file, 9u);
    EXPECT_EQ(next.extent.offset, 0u);
    const Draft& after = add(files, 100, 2, 7, 'c');
    EXPECT_EQ(after.extent.file, 9u);
    EXPECT_EQ(after.extent.offset, 1u);
    EXPECT_EQ(files.bytes(), (std::vector<std::uint64_t>{0, file_limit, 8}));
    EXPECT_EQ(bytes_of(path(9)), "bccccccc");
}

TEST_F(DataFilesTest, WhatWasWrittenAfterACheckpointIsWrittenAgain)
{
    std::vector<std::byte> saved;
    {
        DataFiles files = this->files(0);
        add(files, 0, 0, 40, 'a');
        add(files, 90, 0, 50, 'b');
        files.syncer()();
        ByteWriter out;
        files.save(out);
        saved = out.bytes();
        EXPECT_EQ(saved, checkpoint(40, {0, 50}));
        add(files, 0, 1, 60, 'x');
        add(files, 90, 1, 70, 'x');
        drafts_.resize(2);
        values_.resize(2);
    }
    EXPECT_EQ(std::filesystem::file_size(path(1)), 120u);
    DataFiles files = this->files(0);
    load(files, saved);
    EXPECT_EQ(std::filesystem::file_size(path(1)), 50u);
    for (Draft& draft : drafts_) files.written(draft);
    Draft empty;
    files.written(empty);  // a node without points
    add(files, 1, 1, 30, 'c');
    add(files, 90, 2, 20, 'd');
    EXPECT_EQ(files.appended(), 50u) << "by this one";
    files.finish();
    EXPECT_EQ(files.bytes(), (std::vector<std::uint64_t>{70, 70}));
    expect_chunks(files, 0);
}

// Every file, after its last byte: only then may the index name its chunks.
TEST_F(DataFilesTest, EveryFileIsSyncedOnceItIsComplete)
{
    std::ofstream(path(1)).close();
    std::filesystem::resize_file(path(1), file_limit - 10);
    DataFiles files = this->files(0);
    load(files, checkpoint(0, {0, file_limit - 10}));
    std::vector<std::string> synced;
    const auto times = [&](const std::filesystem::path& file) {
        return std::count(synced.begin(), synced.end(), std::filesystem::canonical(file).string());
    };
    synced_paths = &synced;
    add(files, 100, 0, 10, 'a');
    EXPECT_EQ(times(path(1)), 0);
    add(files, 100, 1, 10, 'b');
    EXPECT_EQ(times(path(1)), 1) << "when the next one begins";
    add(files, 0, 0, 10, 'c');
    EXPECT_EQ(times(path(2)), 0);
    files.syncer()();
    EXPECT_EQ(times(path(2)), 1);
    EXPECT_EQ(times(folder_ / "work" / "front.tmp"), 1);
    EXPECT_EQ(times(folder_ / "tree"), 1);
    add(files, 100, 2, 10, 'd');
    synced.clear();
    files.finish();
    synced_paths = nullptr;
    EXPECT_EQ(times(path(0)), 1);
    EXPECT_EQ(times(path(1)), 0);
    EXPECT_EQ(times(path(2)), 1);
}

TEST_F(DataFilesTest, FilesShorterThanTheCheckpointSaysAreRefused)
{
    std::ofstream(path(1)) << std::string(49, 'b');
    const auto refusal = [&](const std::vector<std::byte>& bytes) -> std::string {
        DataFiles files = this->files(0);
        try {
            load(files, bytes);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(refusal(checkpoint(0, {0, 50})).find("the file has 49 bytes, 50 were expected"), std::string::npos);
    EXPECT_EQ(refusal(checkpoint(0, {0, 49})), "");
    EXPECT_NE(refusal(checkpoint(0, {})).find("a checkpoint names no data files"), std::string::npos);
    EXPECT_NE(refusal(checkpoint(10, {0})), "") << "the front's file is missing";
    EXPECT_NE(refusal(checkpoint(0, {0, 49, 1})), "") << "the second file is missing";
}

}  // namespace
