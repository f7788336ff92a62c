// Tests of the fault injection itself: calls are counted, and each kind of fault does what its name says.

#include "tests/faults.h"
#include "tests/clouds.h"
#include "tests/paths.h"

#include <fcntl.h>
#include <sys/file.h>

#include <fstream>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class Faults : public testing::Test {
protected:
    Faults()
    {
        const Faulty made =
            run_with_fault({pcm::paths::command, "generate", "-n", "2000", (folder_ / "scene.las").string()},
                           folder_ / "none", "count");
        EXPECT_EQ(made.code, 0) << made.err;
        fs::create_directory(folder_ / "out");
    }
    std::vector<std::string> convert() const
    {
        return {pcm::paths::command, "convert", (folder_ / "scene.las").string(), (folder_ / "out/copy.xyz").string()};
    }
    bool empty() const { return fs::is_empty(folder_ / "out"); }
    TemporaryFolder folder_;
};

TEST_F(Faults, CountsOnlyCallsBelowTheFolder)
{
    EXPECT_EQ(count_calls(convert(), folder_ / "elsewhere"), 0);
    fs::remove(folder_ / "out/copy.xyz");
    EXPECT_GE(count_calls(convert(), folder_ / "out"), 3);  // open, write, rename
}

TEST_F(Faults, KillsAtEveryCall)
{
    const long calls = count_calls(convert(), folder_ / "out");
    fs::remove(folder_ / "out/copy.xyz");
    for (const std::string kind : {"kill", "torn"})
        for (const long at : spread(calls, 20)) {
            EXPECT_TRUE(run_with_fault(convert(), folder_ / "out", kind, at).killed) << kind << " at " << at;
            EXPECT_FALSE(fs::exists(folder_ / "out/copy.xyz") && at < calls) << kind << " at " << at;
            EXPECT_TRUE(at == calls || empty()) << kind << " at " << at;  // the bytes had no name
            for (const auto& left : fs::directory_iterator(folder_ / "out")) fs::remove(left);
        }
    EXPECT_EQ(run_with_fault(convert(), folder_ / "out", "kill", calls + 1).code, 0);
}

TEST_F(Faults, FullDiskAndBadDiskAreReportedAndLeaveNothing)
{
    const long calls = count_calls(convert(), folder_ / "out");
    fs::remove(folder_ / "out/copy.xyz");
    for (const long at : spread(calls - 1, 20)) {
        const Faulty full = run_with_fault(convert(), folder_ / "out", "full", at);
        if (full.code != 0) {  // 0: no later call needs space
            EXPECT_EQ(full.code, 1) << at;
            EXPECT_NE(full.err.find("copy.xyz"), std::string::npos) << full.err;
            EXPECT_TRUE(empty()) << at;
        }
        for (const auto& left : fs::directory_iterator(folder_ / "out")) fs::remove(left);
        const Faulty bad = run_with_fault(convert(), folder_ / "out", "eio", at);
        EXPECT_EQ(bad.code, 1) << at;
        EXPECT_NE(bad.err.find("copy.xyz"), std::string::npos) << bad.err;
        for (const auto& left : fs::directory_iterator(folder_ / "out")) fs::remove(left);
    }
}

// The last call makes the new name durable. The file is there, and the command reports it.
TEST_F(Faults, AFileThatMayNotLastIsReported)
{
    const long calls = count_calls(convert(), folder_ / "out");
    const std::uintmax_t bytes = fs::file_size(folder_ / "out/copy.xyz");
    for (const bool exists : {false, true}) {
        fs::remove(folder_ / "out/copy.xyz");
        std::vector<std::string> command = convert();
        if (exists) {
            std::ofstream(folder_ / "out/copy.xyz") << "old";
            command.emplace_back("--overwrite");
        }
        // A file that is replaced takes another rename.
        const Faulty bad = run_with_fault(command, folder_ / "out", "eio", calls + (exists ? 2 : 0));
        EXPECT_EQ(bad.code, 3) << bad.err;
        EXPECT_NE(bad.err.find("in place"), std::string::npos) << bad.err;
        EXPECT_NE(bad.err.find("do not repeat"), std::string::npos) << bad.err;
        EXPECT_EQ(fs::file_size(folder_ / "out/copy.xyz"), bytes);
        EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), {}), 1);
    }
}

// On a file system without files that have no name, a kill leaves a part. The next run removes it, but none that is
// being written, and no other file.
TEST_F(Faults, PartsOfKilledProcessesAreRemoved)
{
    const auto names = [&] {
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder_ / "out")) found.push_back(entry.path().filename());
        std::sort(found.begin(), found.end());
        return found;
    };
    for (const std::string without : {"tmpfile", "linkat"}) {
        setenv("PCM_FAULT_WITHOUT", without.c_str(), 1);
        const long calls = count_calls(convert(), folder_ / "out");
        EXPECT_EQ(names(), std::vector<std::string>{"copy.xyz"}) << without;
        const std::uintmax_t bytes = fs::file_size(folder_ / "out/copy.xyz");
        fs::remove(folder_ / "out/copy.xyz");
        bool left = false;
        for (long at = 1; at <= calls; ++at) {
            ASSERT_TRUE(run_with_fault(convert(), folder_ / "out", "kill", at).killed) << at;
            for (const std::string& name : names()) left = left || name.rfind("copy.xyz.part-", 0) == 0;
            fs::remove(folder_ / "out/copy.xyz");
            EXPECT_EQ(run_with_fault(convert(), folder_ / "out", "count").code, 0);
            EXPECT_EQ(names(), std::vector<std::string>{"copy.xyz"}) << without << ", " << at;
            EXPECT_EQ(fs::file_size(folder_ / "out/copy.xyz"), bytes);
            fs::remove(folder_ / "out/copy.xyz");
        }
        EXPECT_TRUE(left) << without;
        unsetenv("PCM_FAULT_WITHOUT");
    }
    const std::vector<std::string> kept{"copy.xyz",          "copy.xyz.part-1",    "copy.xyz.part-1-2-3",
                                        "copy.xyz.part-1-x", "copy.xyz.part-99-7", "other.xyz.part-1-2"};
    for (const std::string& name : kept)
        if (name != "copy.xyz") std::ofstream(folder_ / "out" / name) << "kept";
    const int writing = open((folder_ / "out/copy.xyz.part-99-7").c_str(), O_RDWR);
    ASSERT_EQ(flock(writing, LOCK_EX), 0);
    EXPECT_EQ(run_with_fault(convert(), folder_ / "out", "count").code, 0);
    EXPECT_EQ(names(), kept);
    close(writing);
}

}  // namespace
