// pcmlab select --extract, killed or with a failing disk at any of its file-changing calls.

#include "pcm/build/builder.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/verify.h"

#include "tests/clouds.h"
#include "tests/faults.h"
#include "tests/paths.h"
#include "tests/sanitizers.h"

#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

struct Extract {
    const char* name;
    const char* output;
    bool replaces = false;  // an earlier output
};

const Extract extracts[] = {
    {"to_a_tree", "part.pct"},
    {"to_a_file", "part.las"},
    {"in_place_of_a_tree", "part.pct", true},
    {"in_place_of_a_file", "part.las", true},
};

class ExtractFaults : public testing::TestWithParam<Extract> {
protected:
    ExtractFaults()
    {
        fs::create_directory(folder_ / "work");
        write_las(folder_ / "cloud.las", records(Shape::surface, 8000, 1), {});
        write_las(folder_ / "part.las", records(Shape::surface, 500, 2), {});
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        build_tree({folder_ / "cloud.las"}, folder_ / "cloud.pct", options);
        build_tree({folder_ / "part.las"}, folder_ / "part.pct", options);
        start_again();
        source_ = state_of(work() / "cloud.pct");
        if (GetParam().replaces) earlier_ = state_of(output());
        calls_ = count_calls(command(), work());
        result_ = state_of(output());
        EXPECT_NE(result_, earlier_);
        expected_ = at_start_;
        expected_.insert(GetParam().output);
    }

    fs::path work() const { return folder_ / "work"; }
    fs::path output() const { return work() / GetParam().output; }
    std::vector<std::string> command() const
    {
        std::vector<std::string> words{paths::command,   "select",          (work() / "cloud.pct").string(),
                                       "--where",        "intensity<20000", "--extract",
                                       output().string()};
        if (GetParam().replaces) words.push_back("--overwrite");
        return words;
    }

    void start_again()
    {
        fs::remove_all(work());
        fs::create_directory(work());
        fs::copy(folder_ / "cloud.pct", work() / "cloud.pct", fs::copy_options::recursive);
        if (GetParam().replaces) fs::copy(folder_ / GetParam().output, output(), fs::copy_options::recursive);
        at_start_ = names();
    }
    std::set<std::string> names() const
    {
        std::set<std::string> all;
        for (const auto& entry : fs::directory_iterator(work())) all.insert(entry.path().filename().string());
        return all;
    }
    // What is there, as text: the hash of a tree that verifies, the bytes of a file.
    std::string state_of(const fs::path& path) const
    {
        if (!fs::exists(path)) return "nothing";
        if (!fs::is_directory(path)) {
            std::ifstream file(path, std::ios::binary);
            return {std::istreambuf_iterator<char>(file), {}};
        }
        const VerifyReport verified = verify_tree(path, 1);
        if (!verified.faults.empty()) return "faulty: " + verified.faults.front();
        return std::to_string(Tree::open(path)->info().content_hash);
    }
    // The source is whole; the output is that of before, or the result as a whole.
    void expect_whole(const std::string& when) const
    {
        EXPECT_EQ(state_of(work() / "cloud.pct"), source_) << when;
        const std::string found = state_of(output());
        EXPECT_TRUE(found == earlier_ || found == result_) << when << ": " << found.substr(0, 200);
    }

    TemporaryFolder folder_;
    std::set<std::string> at_start_, expected_;
    std::string source_, earlier_ = "nothing", result_;
    long calls_ = 0;
};

// Not under the address sanitizer: starts hundreds of processes.
TEST_P(ExtractFaults, PCM_NOT_UNDER_ADDRESS(KilledAtAnyCallLeavesNoHalfOutput))
{
    for (const std::string kind : {"kill", "torn"})
        for (const long at : spread(calls_, 8)) {
            const std::string when = kind + " at call " + std::to_string(at);
            start_again();
            // How many calls there are depends a little on the threads: the last may not be reached.
            const Faulty broken = run_with_fault(command(), work(), kind, at);
            EXPECT_TRUE(broken.killed || (broken.code == 0 && at > calls_ - 4)) << when << ": " << broken.code;
            expect_whole(when);
            // Another run ends as if nothing had been, and clears what was left.
            std::vector<std::string> again = command();
            if (!GetParam().replaces) again.push_back("--overwrite");
            const Faulty done = run_with_fault(again, work(), "count");
            EXPECT_EQ(done.code, 0) << when << ": " << done.err;
            EXPECT_EQ(state_of(output()), result_) << when;
            EXPECT_EQ(names(), expected_) << when;
        }
}

TEST_P(ExtractFaults, AFullOrBadDiskLeavesAllAsItWas)
{
    for (const std::string kind : {"full", "eio"})
        for (const long at : spread(calls_, 10)) {
            const std::string when = kind + " at call " + std::to_string(at);
            start_again();
            const Faulty done = run_with_fault(command(), work(), kind, at);
            expect_whole(when);
            if (done.code == 1) {
                EXPECT_EQ(state_of(output()), earlier_) << when << ": " << done.err;
                EXPECT_EQ(names(), at_start_) << when << ": " << done.err;
                EXPECT_NE(done.err.find(work().string()), std::string::npos) << when << ": " << done.err;
            } else {  // 3: the output is complete, and something after it was not done
                EXPECT_TRUE(done.code == 0 || done.code == 3) << when << ": " << done.err;
                EXPECT_EQ(state_of(output()), result_) << when;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Extracts, ExtractFaults, testing::ValuesIn(extracts),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
