// Tests of the fault injection itself: calls are counted, and each kind of fault does what its name says.

#include "tests/faults.h"
#include "tests/clouds.h"
#include "tests/paths.h"

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

}  // namespace
