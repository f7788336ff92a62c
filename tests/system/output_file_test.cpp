#include "pcm/system/output_file.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

namespace {

using namespace pcm;

std::string contents(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::size_t files_in(const std::filesystem::path& folder)
{
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

TEST(OutputFile, AppearsWhenItIsFinished)
{
    const test::TemporaryFolder folder;
    const auto path = folder / "f";
    std::ofstream(path) << "old";
    {
        OutputFile file(path);
        file.append("a new one");
        EXPECT_EQ(file.size(), 9u);
        EXPECT_EQ(contents(path), "old");
        file.finish();
        EXPECT_EQ(contents(path), "a new one");
        EXPECT_THROW(file.finish(), Error);
    }
    EXPECT_EQ(contents(path), "a new one");
    EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(OutputFile, LeavesNothingWhenItIsNotFinished)
{
    const test::TemporaryFolder folder;
    {
        OutputFile file(folder / "f");
        file.append(std::string(3 << 20, 'x'));
        EXPECT_LE(files_in(folder.path()), 1u);  // none where the file system has files without names
        EXPECT_FALSE(std::filesystem::exists(folder / "f"));
    }
    EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(OutputFile, LeavesWhatStandsInTheWay)
{
    const test::TemporaryFolder folder;
    {
        OutputFile file(folder / "f");
        file.append("text");
        std::filesystem::create_directory(folder / "f");
        std::ofstream(folder / "f" / "inside") << "kept";
        EXPECT_THROW(file.finish(), Error);
    }
    EXPECT_THROW(OutputFile(folder / "f"), Error);
    EXPECT_EQ(contents(folder / "f" / "inside"), "kept");
    EXPECT_EQ(files_in(folder.path()), 1u);
    EXPECT_THROW(OutputFile(folder / "no/such/folder/f"), Error);
}

TEST(OutputFile, TwoOfOneNameDoNotMix)
{
    const test::TemporaryFolder folder;
    OutputFile first(folder / "f"), second(folder / "f");
    first.append("first");
    second.append("the second");
    first.finish();
    EXPECT_EQ(contents(folder / "f"), "first");
    second.finish();
    EXPECT_EQ(contents(folder / "f"), "the second");
    EXPECT_EQ(files_in(folder.path()), 1u);
}

// Appending, extending and rewriting, below, at and above the size of the buffer, against a string.
TEST(OutputFile, HoldsWhatAStringWouldHold)
{
    const test::TemporaryFolder folder;
    std::mt19937_64 random(3);
    for (int round = 0; round < 30; ++round) {
        OutputFile file(folder / "f");
        std::string model;
        for (int step = 0; step < 40; ++step) {
            const std::size_t count = random() % 8 == 0 ? random() % (5 << 19) : random() % 5000;
            std::string bytes(count, ' ');
            for (std::size_t i = 0; i < count; i += 97) bytes[i] = static_cast<char>(random());
            switch (random() % 3) {
                case 0:
                    file.append(bytes);
                    model += bytes;
                    break;
                case 1:
                    std::memcpy(file.extend(count), bytes.data(), count);
                    model += bytes;
                    break;
                default: {
                    const std::size_t offset = random() % (model.size() + 1);
                    bytes.resize(std::min(bytes.size(), model.size() - offset));
                    file.rewrite(bytes.data(), bytes.size(), offset);
                    model.replace(offset, bytes.size(), bytes);
                }
            }
            ASSERT_EQ(file.size(), model.size());
        }
        EXPECT_THROW(file.rewrite("xy", 2, model.size() - 1), Error);
        EXPECT_THROW(file.rewrite("", 0, model.size() + 1), Error);
        file.finish();
        ASSERT_TRUE(contents(folder / "f") == model) << "round " << round;
    }
}

}  // namespace
