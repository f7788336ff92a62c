#include "pcm/remote/block_folder.h"

#include "tests/support.h"

#include <fstream>
#include <iterator>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

const fs::path address = "https://host/site.pct/chunks-000.bpc";
const RemoteVersion version{"\"a\"", "yesterday", 5000000};

std::vector<std::byte> bytes_of(std::size_t size, int seed)
{
    std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 7 + static_cast<std::size_t>(seed));
    return bytes;
}

std::uint64_t bytes_in(const fs::path& folder)
{
    std::uint64_t sum = 0;
    for (const auto& entry : fs::directory_iterator(folder)) sum += entry.file_size();
    return sum;
}

TEST(BlockFolderTest, WhatWasWrittenIsReadByAnotherProcess)
{
    const TemporaryFolder temporary;
    const BlockFolder folder(temporary / "a/b", 1 << 20), other(temporary / "a/b", 1 << 20);
    EXPECT_FALSE(folder.read(address, version, 3));
    folder.write(address, version, 3, bytes_of(1000, 1));
    folder.remember(address, version);
    EXPECT_EQ(other.read(address, version, 3), bytes_of(1000, 1));
    EXPECT_EQ(other.last_version(address), version);
    EXPECT_EQ(fs::status(temporary / "a/b").permissions(), fs::perms::owner_all);
}

TEST(BlockFolderTest, AnotherFileVersionOrNumberIsAnother)
{
    const TemporaryFolder temporary;
    const BlockFolder folder(temporary.path(), 1 << 20);
    folder.write(address, version, 3, bytes_of(1000, 1));
    EXPECT_FALSE(folder.read(address, version, 4));
    EXPECT_FALSE(folder.read("https://host/site.pct/chunks-001.bpc", version, 3));
    for (const RemoteVersion& other :
         {RemoteVersion{"\"b\"", version.modified, version.size}, RemoteVersion{version.tag, "today", version.size},
          RemoteVersion{version.tag, version.modified, version.size + 1}})
        EXPECT_FALSE(folder.read(address, other, 3));
}

TEST(BlockFolderTest, AFileWithAWrongByteCountsAsNone)
{
    const TemporaryFolder temporary;
    const BlockFolder folder(temporary.path(), 1 << 20);
    folder.write(address, version, 3, bytes_of(100, 1));
    const fs::path path = fs::directory_iterator(temporary.path())->path();
    std::ifstream in(path, std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(in), {}};
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ 4);
        std::ofstream(path, std::ios::binary) << damaged;
        EXPECT_FALSE(folder.read(address, version, 3)) << "byte " << i;
    }
    std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - 1);
    EXPECT_FALSE(folder.read(address, version, 3));
    folder.write(address, version, 3, bytes_of(100, 2));  // takes the place of the damaged one
    EXPECT_EQ(folder.read(address, version, 3), bytes_of(100, 2));
}

// Names are checksums, which two blocks may have in common.
TEST(BlockFolderTest, AnotherBlockUnderTheNameCountsAsNone)
{
    const TemporaryFolder temporary;
    const BlockFolder folder(temporary.path(), 1 << 20);
    folder.write(address, version, 3, bytes_of(100, 1));
    const fs::path third = fs::directory_iterator(temporary.path())->path();
    folder.write(address, version, 4, bytes_of(100, 2));
    for (const auto& entry : fs::directory_iterator(temporary.path()))
        if (entry.path() != third) fs::copy_file(third, entry.path(), fs::copy_options::overwrite_existing);
    EXPECT_TRUE(folder.read(address, version, 3));
    EXPECT_FALSE(folder.read(address, version, 4));
}

TEST(BlockFolderTest, ItsBytesAreBoundedAndTheOnesUsedLastStay)
{
    const TemporaryFolder temporary;
    constexpr std::uint64_t most = 20000;
    const BlockFolder folder(temporary.path(), most);
    for (std::uint64_t block = 0; block < 100; ++block) {
        folder.write(address, version, block, bytes_of(1000, static_cast<int>(block)));
        EXPECT_TRUE(folder.read(address, version, 0)) << block;  // and so it is used
        EXPECT_LE(bytes_in(temporary.path()), most);
    }
    EXPECT_TRUE(folder.read(address, version, 99));
    EXPECT_FALSE(folder.read(address, version, 1));
    // A bound that an earlier process did not keep.
    const BlockFolder smaller(temporary.path(), most / 2);
    smaller.write(address, version, 100, bytes_of(1000, 1));
    EXPECT_LE(bytes_in(temporary.path()), most / 2);
    EXPECT_TRUE(smaller.read(address, version, 100));
}

TEST(BlockFolderTest, ACacheThatDoesNotWorkIsNone)
{
    const TemporaryFolder temporary;
    const BlockFolder none(temporary / "none", 0);
    none.write(address, version, 0, bytes_of(10, 1));
    EXPECT_FALSE(none.keeps());
    EXPECT_FALSE(none.read(address, version, 0));
    EXPECT_FALSE(fs::exists(temporary / "none"));
    std::ofstream(temporary / "file") << "x";
    const BlockFolder on_file(temporary / "file", 1 << 20);
    on_file.write(address, version, 0, bytes_of(10, 1));
    EXPECT_FALSE(on_file.read(address, version, 0));
    const BlockFolder small(temporary / "small", 500);
    small.write(address, version, 0, bytes_of(1000, 1));  // larger than all that may stay
    EXPECT_FALSE(small.read(address, version, 0));
}

}  // namespace
