// Filters that make another cloud, killed or with a failing disk at any of their file-changing calls.

#include "pcm/build/builder.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/verify.h"
#include "pcm/update/tree_update.h"

#include "tests/clouds.h"
#include "tests/faults.h"
#include "tests/paths.h"
#include "tests/sanitizers.h"

#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

struct Filter {
    const char* name;
    std::vector<std::string> words;  // the command, its options
    bool in_place = false;
    std::vector<std::string> inputs{"cloud.pct"};
    bool output_first = false;
};

const Filter filters[] = {
    {"voxel", {"voxel", "--size", "900"}},
    {"voxel_in_place", {"voxel", "--size", "900"}, true},
    {"subsample", {"subsample", "--spacing", "900", "--exact"}},
    {"subsample_in_place", {"subsample", "--points", "5000"}, true},
    {"merge", {"merge"}, false, {"cloud.pct", "more.pct"}, true},
    {"voxel_of_a_file", {"voxel", "--size", "900"}, false, {"cloud.las"}},
    {"build_with_normals", {"build", "--normals", "4"}, false, {"cloud.las"}},
    {"resumed_build_with_normals", {"build", "--normals", "4", "--checkpoint-seconds", "0"}, false, {"cloud.las"}},
};

class ResultFaults : public testing::TestWithParam<Filter> {
protected:
    ResultFaults()
    {
        fs::create_directory(folder_ / "work");
        write_las(folder_ / "cloud.las", records(Shape::surface, 20000, 1), {});
        write_las(folder_ / "more.las", records(Shape::surface, 20000, 2), {});
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        options.threads = 1;
        build_tree({folder_ / "cloud.las"}, folder_ / "cloud.pct", options);
        build_tree({folder_ / "more.las"}, folder_ / "more.pct", options);
        before_ = state_of(folder_ / "cloud.pct");
        start_again();
        calls_ = count_calls(command(), work());
        after_ = state_of(result());
        EXPECT_NE(before_, after_);
    }

    fs::path work() const { return folder_ / "work"; }
    fs::path result() const { return work() / (GetParam().in_place ? "cloud.pct" : "result.pct"); }

    void start_again()
    {
        fs::remove_all(work());
        fs::create_directory(work());
        for (const char* name : {"cloud.las", "cloud.pct", "more.pct"})
            fs::copy(folder_ / name, work() / name, fs::copy_options::recursive);
        at_start_ = names();
    }
    std::set<std::string> names() const
    {
        std::set<std::string> all;
        for (const auto& entry : fs::directory_iterator(work())) all.insert(entry.path().filename().string());
        return all;
    }

    std::vector<std::string> command() const
    {
        std::vector<std::string> words{paths::command};
        const Filter& filter = GetParam();
        words.insert(words.end(), filter.words.begin(), filter.words.end());
        if (filter.output_first) words.push_back(result().string());
        for (const std::string& input : filter.inputs) words.push_back((work() / input).string());
        if (filter.in_place)
            words.push_back("--in-place");
        else if (!filter.output_first)
            words.insert(words.end(), {"-o", result().string()});
        words.insert(words.end(), {"-t", "1", "-m", "128M", "--chunk-points", "1000"});
        return words;
    }

    // Differs where the points differ, the number of their attributes, or the number of other files in the folder.
    static std::uint64_t state_of(const fs::path& tree)
    {
        const auto opened = Tree::open(tree);
        return opened->info().content_hash + 1000003 * opened->info().schema.size() +
               leftovers(opened->folder(), opened->data_files().size()).size();
    }
    static std::uint64_t hash_of(const fs::path& tree, const std::string& when)
    {
        const VerifyReport verified = verify_tree(tree, 1);
        EXPECT_TRUE(verified.faults.empty()) << when << ": " << verified.faults.front();
        return state_of(tree);
    }
    // The source is whole; the result is whole, or not there (in place: the source).
    void expect_whole(const std::string& when)
    {
        if (GetParam().in_place) {
            const std::uint64_t hash = hash_of(result(), when);
            EXPECT_TRUE(hash == before_ || hash == after_) << when;
            return;
        }
        EXPECT_EQ(hash_of(work() / "cloud.pct", when), before_) << when;
        if (fs::exists(result())) EXPECT_EQ(hash_of(result(), when), after_) << when;
    }

    TemporaryFolder folder_;
    std::set<std::string> at_start_;
    std::uint64_t before_ = 0, after_ = 0;
    long calls_ = 0;
};

// Not under the address sanitizer: starts hundreds of processes. Nor under the thread sanitizer: starts the command,
// which is not built then.
TEST_P(ResultFaults, PCM_NOT_UNDER_SANITIZERS(KilledAtAnyCallLeavesTheSourceAndNoHalfResult))
{
    for (const long at : spread(calls_, 12)) {
        const std::string when = "killed at call " + std::to_string(at);
        start_again();
        EXPECT_TRUE(run_with_fault(command(), work(), "kill", at).killed) << when;
        expect_whole(when);
        // Another run ends as if nothing had been.
        std::vector<std::string> again = command();
        if (!GetParam().in_place) again.push_back("--overwrite");
        if (GetParam().in_place && state_of(result()) == after_) continue;
        const Faulty result_of_it = run_with_fault(again, work(), "count");
        EXPECT_EQ(result_of_it.code, 0) << when << ": " << result_of_it.err;
        EXPECT_EQ(hash_of(result(), when), after_);
        std::set<std::string> expected = at_start_;
        expected.insert(result().filename().string());
        EXPECT_EQ(names(), expected) << when;
    }
}

// Not under the thread sanitizer: starts the command, which is not built then.
TEST_P(ResultFaults, PCM_NOT_UNDER_THREAD(AFullOrBadDiskLeavesTheSourceAndNothingElse))
{
    for (const std::string kind : {"full", "eio"})
        for (const long at : spread(calls_ - 1, 8)) {
            const std::string when = kind + " at call " + std::to_string(at);
            start_again();
            const Faulty result_of_it = run_with_fault(command(), work(), kind, at);
            expect_whole(when);
            // Working names mean nothing to users.
            for (const char* working : {"input.pct", ".part/tree/"})
                EXPECT_EQ(result_of_it.err.find(working), std::string::npos) << when << ": " << result_of_it.err;
            if (result_of_it.code == 1)
                EXPECT_EQ(names(), at_start_) << when << ": " << result_of_it.err;
            else
                EXPECT_TRUE(result_of_it.code == 0 || result_of_it.code == 3) << when << ": " << result_of_it.err;
        }
}

INSTANTIATE_TEST_SUITE_P(Filters, ResultFaults, testing::ValuesIn(filters),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
