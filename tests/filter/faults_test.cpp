// Filters that are killed, or whose disk fails them, at their file-changing calls: the tree that they were given stays
// what it was, and what they write is the old tree or the new one, or not there.

#include "tests/faults.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/verify.h"
#include "pcm/update/tree_update.h"
#include "tests/filter/oracle.h"
#include "tests/sanitizers.h"

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

struct FaultCase {
    const char* name;
    std::vector<std::string> words;  // arguments of the command, without the tree
    bool in_place;
    bool scratch = false;  // its scratch files fail, too
};

class FilterFaults : public testing::TestWithParam<FaultCase> {
protected:
    struct State {
        std::uint64_t hash = 0, points = 0;
        std::size_t attributes = 0;
        bool operator==(const State& o) const
        {
            return hash == o.hash && points == o.points && attributes == o.attributes;
        }
    };

    FilterFaults()
    {
        build_small(cloud_of(4000, 31,
                             [](double u, double v, double w) {
                                 return Vec3d{10 * u, 8 * v, w > 0.995 ? 5.0 : std::sin(3 * u)};
                             }),
                    folder_ / "before.pct");
        start_again();
        before_ = state_of(tree_);
        calls_ = count_calls(command(), work_);
        after_ = state_of(result());
        EXPECT_FALSE(before_ == after_);
    }

    fs::path result() const { return GetParam().in_place ? tree_ : work_ / "result.pct"; }

    void start_again()
    {
        fs::remove_all(work_);
        fs::create_directories(scratch_);
        fs::copy(folder_ / "before.pct", tree_, fs::copy_options::recursive);
    }

    std::vector<std::string> command() const
    {
        std::vector<std::string> words;
        if (GetParam().scratch) words = {"/usr/bin/env", "TMPDIR=" + scratch_.string()};
        words.push_back(paths::command);
        words.insert(words.end(), GetParam().words.begin(), GetParam().words.end());
        words.push_back(tree_.string());
        if (GetParam().in_place)
            words.push_back("--in-place");
        else
            words.insert(words.end(), {"-o", result().string()});
        return words;
    }

    static State state_of(const fs::path& tree)
    {
        const auto opened = Tree::open(tree);
        return {opened->info().content_hash, opened->info().points, opened->info().schema.size()};
    }

    // Returns whether the result is there. A copy is the result or is not there: never the original under its name.
    bool expect_old_or_new(const std::string& when)
    {
        if (!GetParam().in_place) {
            EXPECT_TRUE(verify_tree(tree_, 1).faults.empty()) << when;
            EXPECT_TRUE(state_of(tree_) == before_) << when;
            EXPECT_TRUE(leftovers(tree_, Tree::open(tree_)->data_files().size()).empty()) << when;
            if (!fs::exists(result())) return false;
            EXPECT_TRUE(state_of(result()) == after_) << when;
        }
        const VerifyReport verified = verify_tree(result(), 1);
        EXPECT_TRUE(verified.faults.empty()) << when << ": " << verified.faults.front();
        const State now = state_of(result());
        EXPECT_TRUE(now == before_ || now == after_) << when;
        return now == after_;
    }

    // The same command again ends as if nothing had been, and nothing is left.
    void expect_repeatable(const std::string& when)
    {
        const Faulty again = run_with_fault(command(), work_, "count");
        EXPECT_EQ(again.code, 0) << when << ": " << again.err;
        ASSERT_TRUE(is_tree(result())) << when;
        EXPECT_TRUE(state_of(result()) == after_) << when;
        EXPECT_TRUE(verify_tree(result(), 1).faults.empty()) << when;
        EXPECT_TRUE(leftovers(result(), Tree::open(result())->data_files().size()).empty()) << when;
        const auto entries = std::distance(fs::directory_iterator(work_), fs::directory_iterator());
        EXPECT_EQ(entries, GetParam().in_place ? 2 : 3) << when;  // tree, scratch, result
    }

    const TemporaryFolder folder_;
    const fs::path work_ = folder_ / "work", tree_ = work_ / "tree.pct", scratch_ = work_ / "scratch";
    State before_, after_;
    long calls_ = 0;
};

// A small limit of memory: most chunks are written long before the end.
INSTANTIATE_TEST_SUITE_P(
    Commands, FilterFaults,
    testing::Values(
        FaultCase{"normals", {"normals", "--radii", "-k", "3", "-t", "1"}, true},
        FaultCase{"outliers", {"outliers", "-a", "1", "-k", "3", "-t", "1"}, true},
        FaultCase{"outliers_of_a_copy", {"outliers", "-a", "1", "-k", "3", "-t", "1"}, false},
        FaultCase{"labels", {"outliers", "--label", "-a", "1", "-k", "3", "-t", "1"}, true},
        FaultCase{"set_saved", {"select", "--sphere", "5", "4", "0", "3", "--save-attribute", "a"}, true},
        FaultCase{"set_saved_in_a_copy", {"select", "--sphere", "5", "4", "0", "3", "--save-attribute", "a"}, false},
        FaultCase{"set_classified", {"select", "--sphere", "5", "4", "0", "3", "--classify", "7"}, true},
        FaultCase{"set_deleted", {"select", "--sphere", "5", "4", "0", "3", "--delete"}, true},
        FaultCase{"set_deleted_from_a_copy", {"select", "--sphere", "5", "4", "0", "3", "--delete"}, false},
        FaultCase{"detected",
                  {"detect", "--label", "a", "--pieces", "--min-points", "50", "--threshold", "0.3", "-t", "1"},
                  true,
                  true},
        FaultCase{"detected_in_a_copy",
                  {"detect", "--label", "a", "--pieces", "--min-points", "50", "--threshold", "0.3", "-t", "1"},
                  false,
                  true},
        FaultCase{"normals_of_a_copy", {"normals", "--radii", "-k", "3", "-t", "1"}, false}),
    [](const auto& info) { return info.param.name; });

// Not under the address sanitizer: starts hundreds of processes. Nor under the thread sanitizer: starts the command,
// which is not built then.
TEST_P(FilterFaults, PCM_NOT_UNDER_SANITIZERS(KilledAtAnyCall))
{
    EXPECT_GE(calls_, 20);
    for (const long at : spread(calls_, 40)) {
        const std::string when = "killed at " + std::to_string(at) + " of " + std::to_string(calls_);
        start_again();
        ASSERT_TRUE(run_with_fault(command(), work_, "kill", at).killed) << when;
        if (!expect_old_or_new(when) && at % 3 == 0) expect_repeatable(when);
    }
}

// Not under the thread sanitizer: starts the command, which is not built then.
TEST_P(FilterFaults, PCM_NOT_UNDER_THREAD(AFullDisk))
{
    for (const long at : spread(calls_, tries(25, 3))) {
        const std::string when = "full at " + std::to_string(at) + " of " + std::to_string(calls_);
        start_again();
        const Faulty full = run_with_fault(command(), work_, "full", at);
        const bool is_new = expect_old_or_new(when);
        EXPECT_EQ(full.code, is_new ? 0 : 1) << when << ": " << full.err;
        if (!is_new) EXPECT_NE(full.err.find("space"), std::string::npos) << full.err;
    }
}

TEST_P(FilterFaults, PCM_NOT_UNDER_THREAD(ABadDisk))
{
    std::vector<long> instants = spread(calls_, tries(15, 3));
    for (long at = std::max(1L, calls_ - tries(10, 1)); at <= calls_; ++at) instants.push_back(at);
    for (const long at : instants) {
        const std::string when = "eio at " + std::to_string(at) + " of " + std::to_string(calls_);
        start_again();
        const Faulty bad = run_with_fault(command(), work_, "eio", at);
        const bool is_new = expect_old_or_new(when);
        if (bad.code == 0) EXPECT_TRUE(is_new) << when;
        if (bad.code == 3) EXPECT_TRUE(is_new) << when << bad.err;
        if (bad.code == 1) EXPECT_FALSE(is_new) << when << bad.err;
        if (bad.code != 0) EXPECT_NE(bad.err.find(work_.string()), std::string::npos) << bad.err;  // names the file
        EXPECT_TRUE(fs::is_empty(scratch_)) << when;
    }
}

}  // namespace
