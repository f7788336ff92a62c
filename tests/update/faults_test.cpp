// Updates that are killed, or whose disk fails them, at any of their file-changing calls.

#include "tests/faults.h"
#include "pcm/build/builder.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/verify.h"
#include "pcm/update/tree_update.h"
#include "tests/clouds.h"
#include "tests/paths.h"
#include "tests/sanitizers.h"

#include <fstream>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

// All files in a folder but the lock file.
Files files_in(const fs::path& folder)
{
    Files files;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name == lock_file_name) continue;
        if (entry.is_directory()) {
            files[name] = "a folder";
            continue;
        }
        std::ifstream file(entry.path(), std::ios::binary);
        files[name] = std::string(std::istreambuf_iterator<char>(file), {});
    }
    return files;
}

// Which state a tree is in: of one whose chunks may be written in another order each time, not byte by byte.
struct State {
    Files files;
    std::uint64_t hash = 0;
    std::size_t attributes = 0;
    bool bytes_count = true;

    bool operator==(const State& o) const
    {
        if (bytes_count) return files == o.files;
        const auto same_name = [](const auto& a, const auto& b) { return a.first == b.first; };
        return hash == o.hash && attributes == o.attributes && files.size() == o.files.size() &&
               std::equal(files.begin(), files.end(), o.files.begin(), same_name);
    }
};

class UpdateFaults : public testing::TestWithParam<const char*> {
protected:
    UpdateFaults()
    {
        write_las(folder_ / "first.las", records(Shape::surface, 40000, 1), {});
        write_las(folder_ / "second.las", records(Shape::surface, 40000, 2), {});
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        options.threads = 1;
        build_tree({folder_ / "first.las"}, folder_ / "before.pct", options);
        before_ = state_of(folder_ / "before.pct");
        start_again();
        calls_ = count_calls(command(), tree_);
        after_ = state_of(tree_);
        EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
        EXPECT_NE(before_.hash, after_.hash);
    }

    static bool sets() { return GetParam() == std::string("set"); }
    static State state_of(const fs::path& tree)
    {
        State state{files_in(tree), 0, 0, !sets()};
        const auto opened = Tree::open(tree);
        state.hash = opened->info().content_hash;
        state.attributes = opened->info().schema.size();
        return state;
    }

    void start_again()
    {
        fs::remove_all(tree_);
        fs::copy(folder_ / "before.pct", tree_, fs::copy_options::recursive);
    }

    std::vector<std::string> command() const
    {
        const std::string name = GetParam();
        if (name == "append")
            return {
                paths::command, "append",         tree_.string(), (folder_ / "second.las").string(), "-t", "1", "-m",
                "64M",          "--chunk-points", "1000"};
        // A cache of few chunks: most are written long before the end.
        if (name == "set")
            return {paths::command, "set",     tree_.string(),        "--new",   "height:f32", "height=1.5",
                    "intensity=7",  "--where", "classification=1..9", "--cache", "100K"};
        return {paths::command, "delete", tree_.string(), "--where", "classification=1..9", "-t", "1"};
    }

    // The tree is whole, and the old one or the new one; returns whether it is the new one.
    bool expect_old_or_new(const std::string& when)
    {
        const VerifyReport verified = verify_tree(tree_, 1);
        EXPECT_TRUE(verified.faults.empty()) << when << ": " << verified.faults.front();
        const State now = state_of(tree_);
        if (sets()) {
            EXPECT_TRUE(now.hash == before_.hash || now.hash == after_.hash) << when;
            return now.hash == after_.hash;
        }
        const std::string index = now.files.at(index_file_name);
        EXPECT_TRUE(index == before_.files[index_file_name] || index == after_.files[index_file_name]) << when;
        return index == after_.files[index_file_name];
    }

    void expect_new_after_another_run(const std::string& when)
    {
        const Faulty again = run_with_fault(command(), folder_ / "none", "count");
        EXPECT_EQ(again.code, 0) << when << ": " << again.err;
        EXPECT_TRUE(state_of(tree_) == after_) << when;
    }

    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "tree.pct";
    State before_, after_;
    long calls_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Commands, UpdateFaults, testing::Values("append", "delete", "set"),
                         [](const auto& info) { return info.param; });

// Not under the address sanitizer: starts hundreds of processes. Nor under the thread sanitizer: starts the command,
// which is not built then.
TEST_P(UpdateFaults, PCM_NOT_UNDER_SANITIZERS(KilledAtAnyCall))
{
    EXPECT_GE(calls_, 40);
    long instants = 0, runs = 0;
    std::vector<std::string> kinds{"kill", "torn"};
    if (sets()) kinds.push_back("kill");  // chunks are written in another order each time
    for (const std::string& kind : kinds)
        for (const long at : spread(calls_, sets() ? 110 : 60)) {
            const std::string when = kind + " at " + std::to_string(at) + " of " + std::to_string(calls_);
            start_again();
            ASSERT_TRUE(run_with_fault(command(), tree_, kind, at).killed) << when;
            ++instants;
            // Another run is half of the test's time: only every third, and those near the last calls.
            if (!expect_old_or_new(when) && (instants % 3 == 0 || at + 12 > calls_)) {
                expect_new_after_another_run(when);
                ++runs;
            }
        }
    EXPECT_GE(instants, sets() ? 200 : 100);
    EXPECT_GE(runs, 30);
}

// Not under the thread sanitizer: starts the command, which is not built then.
TEST_P(UpdateFaults, PCM_NOT_UNDER_THREAD(AFullDisk))
{
    for (const long at : spread(calls_, tries(25, 4))) {
        const std::string when = "full at " + std::to_string(at);
        start_again();
        const Faulty full = run_with_fault(command(), tree_, "full", at);
        const bool is_new = expect_old_or_new(when);
        EXPECT_EQ(full.code, is_new ? 0 : 1) << when;
        if (is_new) continue;  // nothing needed space any more
        EXPECT_NE(full.err.find("tree.pct"), std::string::npos) << full.err;
        EXPECT_NE(full.err.find("space"), std::string::npos) << full.err;
        EXPECT_TRUE(state_of(tree_) == before_) << when;
        if (at % 4 == 0) expect_new_after_another_run(when);
    }
}

TEST_P(UpdateFaults, PCM_NOT_UNDER_SANITIZERS(ABadDisk))
{
    std::vector<long> instants = spread(calls_, 20);
    for (long at = std::max(1L, calls_ - 15); at <= calls_; ++at) instants.push_back(at);
    for (const long at : instants) {
        const std::string when = "eio at " + std::to_string(at) + " of " + std::to_string(calls_);
        start_again();
        const Faulty bad = run_with_fault(command(), tree_, "eio", at);
        const bool is_new = expect_old_or_new(when);
        if (bad.code == 0) {
            EXPECT_TRUE(is_new) << when;
        } else {
            EXPECT_EQ(bad.code, is_new ? 3 : 1) << when;
            EXPECT_NE(bad.err.find("tree.pct"), std::string::npos) << bad.err;
        }
        State left = state_of(tree_);
        // Where the disk refused to remove a scratch file, the next update does.
        const bool scratch = left.files.erase(update_scratch_name);
        if (!is_new) EXPECT_TRUE(left == before_) << when;
        if (scratch && !is_new) expect_new_after_another_run(when);
    }
}

}  // namespace
