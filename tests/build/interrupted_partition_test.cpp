// A build that was killed when all points were in bins and none was sorted, and whose bins are missing since.

#include "pcm/build/bins/bins.h"
#include "pcm/build/builder.h"
#include "pcm/build/checkpoints.h"
#include "pcm/build/journal.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/faults.h"
#include "tests/paths.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// So few points that there is one bin, which is also the first.
class InterruptedPartitionFaults : public testing::Test {
protected:
    InterruptedPartitionFaults()
    {
        fs::create_directory(work());
        write_las(folder_ / "in.las", records(Shape::surface, 4000, 31), {});
        build_tree({folder_ / "in.las"}, folder_ / "reference.pct", options());
        reference_ = contents(folder_ / "reference.pct");
    }
    static BuildOptions options()
    {
        BuildOptions options = small_chunks();
        options.checkpoint_seconds = 0;
        return options;
    }
    fs::path work() const { return folder_ / "work"; }
    fs::path out() const { return work() / "out.pct"; }
    fs::path part() const { return work() / "out.pct.part"; }

    // Whether the journal's last checkpoint is that of the bins.
    bool has_bins_alone() const
    {
        if (!fs::exists(part() / "journal")) return false;
        std::set<std::uint32_t> kinds;
        const Journal journal(part() / "journal");
        for (const Journal::Record& record : journal.records()) kinds.insert(record.kind);
        return kinds.count(Checkpoints::partitioned) && !kinds.count(Checkpoints::sorted) &&
               fs::file_size(part() / scratch_file_name) > 0;
    }
    // Kills builds one call later each time, until one has its bins on disk and nothing more.
    void kill_after_partition() const
    {
        const std::vector<std::string> command{paths::command,
                                               "build",
                                               (folder_ / "in.las").string(),
                                               "-o",
                                               out().string(),
                                               "--memory",
                                               "64M",
                                               "--chunk-points",
                                               "1000",
                                               "--threads",
                                               "2",
                                               "-q",
                                               "--checkpoint-seconds",
                                               "0"};
        const long calls = count_calls(command, work());
        for (int pass = 0; pass < 5; ++pass)  // checkpoints are made by a thread of their own
            for (long at = 1; at < calls; ++at) {
                fs::remove_all(out());
                fs::remove_all(part());
                if (run_with_fault(command, work(), "kill", at).killed && has_bins_alone()) return;
            }
        FAIL() << "no build was killed when its points were in bins";
    }
    // Builds again; returns whether its progress named a resumed stage, and its notes.
    std::pair<bool, std::string> build_again() const
    {
        bool resumes = false;
        BuildOptions with = options();
        with.progress = [&](const ProgressUpdate& update) {
            resumes = resumes || update.stage.find("Resuming") != std::string_view::npos;
            return true;
        };
        std::string notes;
        for (const std::string& note : build_tree({folder_ / "in.las"}, out(), with).notes) notes += note + "\n";
        EXPECT_TRUE(contents(out()) == reference_);
        return {resumes, notes};
    }

    TemporaryFolder folder_;
    Contents reference_;
};

// Not under the thread sanitizer: starts the command, which is not built then.
TEST_F(InterruptedPartitionFaults, PCM_NOT_UNDER_THREAD(IsResumedWhereItsBinsAreThere))
{
    kill_after_partition();
    const auto [resumes, notes] = build_again();
    EXPECT_TRUE(resumes);
    EXPECT_NE(notes.find("was resumed"), std::string::npos) << notes;
}

// That is found before the first point is sorted; no progress report says that the build resumes.
TEST_F(InterruptedPartitionFaults, PCM_NOT_UNDER_THREAD(IsRestartedAtOnceWhereTheFirstBinIsMissing))
{
    kill_after_partition();
    fs::resize_file(part() / scratch_file_name, 0);
    const auto [resumes, notes] = build_again();
    EXPECT_FALSE(resumes);
    EXPECT_NE(notes.find("was restarted"), std::string::npos) << notes;
}

}  // namespace
