#include "pcm/system/output_group.h"

#include "pcm/system/error.h"
#include "pcm/system/output_file.h"
#include "tests/support.h"

#include <fstream>
#include <iterator>
#include <map>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

class OutputGroups : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text)
    {
        OutputFile file(folder_ / name);
        file.append(text);
        file.finish();
    }
    Files files() const
    {
        Files found;
        for (const auto& entry : fs::directory_iterator(folder_.path())) {
            std::ifstream file(entry.path(), std::ios::binary);
            found[entry.path().filename().string()] = {std::istreambuf_iterator<char>(file), {}};
        }
        return found;
    }
    const TemporaryFolder folder_;
};

TEST_F(OutputGroups, GivesAllFilesTheirNamesAtTheEnd)
{
    write("b", "old");
    {
        OutputGroup group;
        write("a", "1");
        write("b", "2");
        write("c", "3");
        EXPECT_EQ(files(), (Files{{"b", "old"}}));
        group.put_in_place();
        EXPECT_EQ(files(), (Files{{"a", "1"}, {"b", "2"}, {"c", "3"}}));
        write("d", "4");  // the group is complete: this file is by itself
        EXPECT_EQ(files().count("d"), 1u);
    }
    EXPECT_EQ(files(), (Files{{"a", "1"}, {"b", "2"}, {"c", "3"}, {"d", "4"}}));
}

TEST_F(OutputGroups, DropsFilesThatAreNotPutInPlace)
{
    write("b", "old");
    {
        const OutputGroup group;
        write("a", "1");
        write("b", "2");
    }
    EXPECT_EQ(files(), (Files{{"b", "old"}}));
    write("a", "by itself");
    EXPECT_EQ(files(), (Files{{"a", "by itself"}, {"b", "old"}}));
}

TEST_F(OutputGroups, PutsBackWhatItReplacedWhenOneCannotBePlaced)
{
    write("b", "old");
    OutputGroup group;
    write("a", "1");
    write("b", "2");
    write("c", "3");
    fs::create_directories(folder_ / "c" / "in the way");
    EXPECT_THROW(group.put_in_place(), Error);
    fs::remove_all(folder_ / "c");
    EXPECT_EQ(files().at("b"), "old");
    EXPECT_EQ(files().count("a"), 0u);
}

TEST_F(OutputGroups, LeavesNothingBehindAfterAFailure)
{
    write("b", "old");
    {
        OutputGroup group;
        write("b", "2");
        write("c", "3");
        fs::create_directories(folder_ / "c" / "in the way");
        EXPECT_THROW(group.put_in_place(), Error);
    }
    fs::remove_all(folder_ / "c");
    EXPECT_EQ(files(), (Files{{"b", "old"}}));
}

TEST_F(OutputGroups, TwoOutputsOfOneNameAreRefused)
{
    fs::create_symlink("a", folder_ / "link");
    OutputGroup group;
    write("a", "1");
    EXPECT_THROW(write("a", "2"), Error);
    EXPECT_THROW(write("./a", "2"), Error);
    EXPECT_THROW(write("link", "2"), Error);
    group.put_in_place();
    EXPECT_EQ(files().at("a"), "1");
}

TEST_F(OutputGroups, ConcernOneThread)
{
    const OutputGroup group;
    std::thread([&] { write("a", "1"); }).join();
    EXPECT_EQ(files(), (Files{{"a", "1"}}));
}

}  // namespace
