// Builds that are killed, and builds whose disk fails, at every kind of instant.

#include "pcm/build/build_folder.h"
#include "pcm/build/builder.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/unfinished_build.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/faults.h"
#include "tests/paths.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <fstream>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

bool has_note(const BuildReport& report, const std::string& text)
{
    for (const std::string& note : report.notes)
        if (note.find(text) != std::string::npos) return true;
    return false;
}

// A cloud of several bins and some hundred chunks; a checkpoint wherever there can be one.
class BuildFaults : public testing::Test {
protected:
    void SetUp() override
    {
        fs::create_directory(folder_ / "work");
        write_las(folder_ / "in.las", records(Shape::surface, 45000, 31), {});
        build_tree({folder_ / "in.las"}, folder_ / "reference.pct", options());
        reference_ = contents(folder_ / "reference.pct");
    }
    BuildOptions options() const
    {
        BuildOptions options;
        options.chunk_points = 1000;
        options.memory_bytes = 64 << 20;
        options.threads = 2;
        options.checkpoint_seconds = 0;
        return options;
    }
    fs::path work() const { return folder_ / "work"; }
    fs::path out() const { return work() / "out.pct"; }
    fs::path part() const { return work() / "out.pct.part"; }
    std::vector<std::string> command(const std::string& more = {}, const std::string& input = "in.las") const
    {
        std::vector<std::string> words{paths::command,
                                       "build",
                                       (folder_ / input).string(),
                                       "-o",
                                       out().string(),
                                       "--chunk-points",
                                       "1000",
                                       "--memory",
                                       "64M",
                                       "--threads",
                                       "2",
                                       "--checkpoint-seconds",
                                       "0",
                                       "-q"};
        if (!more.empty()) words.push_back(more);
        return words;
    }
    void clean()
    {
        fs::remove_all(out());
        fs::remove_all(part());
    }
    BuildReport build_again(BuildOptions with)
    {
        const BuildReport report = build_tree({folder_ / "in.las"}, out(), with);
        EXPECT_EQ(names_in(work()), std::vector<std::string>{"out.pct"});
        return report;
    }
    // A build that was killed at about this share of its calls.
    void interrupt(double share)
    {
        clean();
        const long calls = count_calls(command(), work());
        clean();
        ASSERT_TRUE(
            run_with_fault(command(), work(), "kill", static_cast<long>(share * static_cast<double>(calls))).killed);
        ASSERT_TRUE(fs::exists(part() / "building"));
    }

    TemporaryFolder folder_;
    Contents reference_;
};

// Not under the address sanitizer: starts hundreds of processes. Nor under the thread sanitizer: starts the command,
// which is not built then.
TEST_F(BuildFaults, PCM_NOT_UNDER_SANITIZERS(KilledAtAnyCallItResumesAndMakesTheSameTree))
{
    const long calls = count_calls(command(), work());
    EXPECT_GT(calls, 100);
    int killed = 0, resumed = 0, restarted = 0;
    for (const char* kind : {"kill", "torn"}) {
        std::vector<long> instants = spread(calls, kind == std::string("kill") ? 48 : 16);
        for (long at = 7; at <= 12; ++at)
            instants.push_back(at);  // the journal knows the build by then, and has no checkpoint
        for (const long at : instants) {
            clean();
            const Faulty first = run_with_fault(command(), work(), kind, at);
            killed += first.killed;
            if (fs::exists(out())) {
                EXPECT_TRUE(contents(out()) == reference_) << kind << " at " << at;
                // Done, but for what was to be cleaned up.
                EXPECT_THROW(build_again(options()), Error);
                EXPECT_EQ(names_in(work()), std::vector<std::string>{"out.pct"});
                continue;
            }
            BuildOptions with = options();
            with.threads = at % 2 ? 1 : 3;
            const BuildReport report = build_again(with);
            EXPECT_TRUE(contents(out()) == reference_) << kind << " at " << at;
            resumed += has_note(report, "an interrupted build was resumed");
            restarted += has_note(report, "an interrupted build was restarted");
        }
    }
    EXPECT_GT(killed, 64);
    EXPECT_GT(resumed, 20);
    EXPECT_GT(restarted, 2);
}

// Not under the thread sanitizer: starts the command, which is not built then.
TEST_F(BuildFaults, PCM_NOT_UNDER_THREAD(KilledAgainAndAgain))
{
    const long calls = count_calls(command(), work());
    clean();
    int killed = 0;
    while (!fs::exists(out())) {
        killed += run_with_fault(command(), work(), "kill", calls * 2 / 5).killed;
        ASSERT_LT(killed, 50);
    }
    EXPECT_GT(killed, 1);
    EXPECT_TRUE(contents(out()) == reference_);
}

// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(BuildFaults, PCM_NOT_UNDER_SANITIZERS(ATreeThatIsOverwrittenIsThereAtAnyTime))
{
    write_las(folder_ / "old.las", records(Shape::volume, 3000, 32), {});
    build_tree({folder_ / "old.las"}, folder_ / "old.pct", options());
    const Contents old = contents(folder_ / "old.pct");
    const auto put_old = [&] {
        clean();
        fs::copy(folder_ / "old.pct", out());
    };
    put_old();
    const long calls = count_calls(command("--overwrite"), work());
    int kept = 0, replaced = 0;
    std::vector<long> instants = spread(calls, 12);
    for (long at = calls - 24; at < calls; at += 2) instants.push_back(at);  // around the exchange
    for (const long at : instants) {
        put_old();
        run_with_fault(command("--overwrite"), work(), "kill", at);
        const Contents now = contents(out());
        EXPECT_TRUE(now == old || now == reference_) << at;
        kept += now == old;
        replaced += now == reference_;
        BuildOptions with = options();
        with.overwrite = true;
        build_again(with);
        EXPECT_TRUE(contents(out()) == reference_) << at;
    }
    EXPECT_GT(kept, 5);
    EXPECT_GT(replaced, 0);
}

// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(BuildFaults, PCM_NOT_UNDER_SANITIZERS(ADiskThatIsFullOrFailsLeavesNothingBehind))
{
    write_las(folder_ / "old.las", records(Shape::volume, 3000, 32), {});
    build_tree({folder_ / "old.las"}, folder_ / "old.pct", options());
    const Contents old = contents(folder_ / "old.pct");
    const long calls = count_calls(command(), work());
    int failed = 0;
    for (const char* kind : {"full", "eio"})
        for (const long at : spread(calls, 24)) {
            const bool overwrite = at % 2 == 0;
            clean();
            if (overwrite) fs::copy(folder_ / "old.pct", out());
            const Faulty result = run_with_fault(command(overwrite ? "--overwrite" : ""), work(), kind, at);
            if (result.code == 0) {  // it could do without that call
                EXPECT_TRUE(contents(out()) == reference_) << kind << " at " << at;
                continue;
            }
            ++failed;
            EXPECT_EQ(result.code, 1) << kind << " at " << at;
            EXPECT_NE(result.err.find("out.pct"), std::string::npos) << result.err;
            if (kind == std::string("full")) EXPECT_NE(result.err.find("space"), std::string::npos) << result.err;
            EXPECT_FALSE(fs::exists(part())) << kind << " at " << at << ": " << result.err;
            EXPECT_EQ(fs::exists(out()), overwrite) << kind << " at " << at << ": " << result.err;
            if (overwrite) EXPECT_TRUE(contents(out()) == old) << kind << " at " << at;
        }
    EXPECT_GT(failed, 25);
}

// Through the spool: doubles that are read in order.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(BuildFaults, PCM_NOT_UNDER_SANITIZERS(OfDoublesToo))
{
    std::vector<std::array<double, 3>> points;
    for (const LasRecord& p : records(Shape::surface, 20000, 33))
        points.push_back({p.x * 0.001, p.y * 0.001, p.z * 0.001});
    write_ply(folder_ / "in.ply", points);
    build_tree({folder_ / "in.ply"}, folder_ / "doubles.pct", options());
    const Contents reference = contents(folder_ / "doubles.pct");
    const long calls = count_calls(command({}, "in.ply"), work());
    for (const long at : spread(calls, 16)) {
        clean();
        run_with_fault(command({}, "in.ply"), work(), "kill", at);
        if (!fs::exists(out())) build_tree({folder_ / "in.ply"}, out(), options());
        EXPECT_TRUE(contents(out()) == reference) << at;
    }
}

TEST_F(BuildFaults, PCM_NOT_UNDER_THREAD(AnotherBuildStartsFromTheBeginning))
{
    // Other options.
    interrupt(0.9);
    BuildOptions other = options();
    other.chunk_points = 1500;
    EXPECT_TRUE(has_note(build_again(other), "other options"));
    EXPECT_FALSE(contents(out()) == reference_);
    // The file has changed.
    interrupt(0.9);
    fs::last_write_time(folder_ / "in.las", fs::last_write_time(folder_ / "in.las") + std::chrono::seconds(1));
    EXPECT_TRUE(has_note(build_again(options()), "other files"));
    EXPECT_TRUE(contents(out()) == reference_);
    // Unasked.
    interrupt(0.9);
    BuildOptions fresh = options();
    fresh.resume = false;
    EXPECT_FALSE(has_note(build_again(fresh), "was resumed"));
    EXPECT_TRUE(contents(out()) == reference_);
    // The same again is resumed, with other options that do not shape the tree.
    interrupt(0.9);
    BuildOptions same = options();
    same.threads = 5;
    same.memory_bytes = 300 << 20;
    same.checkpoint_seconds = 100;
    EXPECT_TRUE(has_note(build_again(same), "was resumed"));
    EXPECT_TRUE(contents(out()) == reference_);
}

TEST_F(BuildFaults, PCM_NOT_UNDER_THREAD(AResumedBuildReportsTheLinesThatWereSkippedBefore))
{
    std::ofstream text(folder_ / "in.xyz");
    for (const LasRecord& p : records(Shape::surface, 20000, 34)) text << p.x << ' ' << p.y << ' ' << p.z << '\n';
    text << "1 oops 3\n" << std::flush;
    const auto words = command("--skip-bad-lines", "in.xyz");
    const long calls = count_calls(words, work());
    clean();
    ASSERT_TRUE(run_with_fault(words, work(), "kill", calls * 9 / 10).killed);
    BuildOptions skipping = options();
    skipping.read.skip_bad_lines = true;
    const BuildReport report = build_tree({folder_ / "in.xyz"}, out(), skipping);
    EXPECT_TRUE(has_note(report, "was resumed"));
    EXPECT_TRUE(has_note(report, "1 bad line was skipped, the first is line 20001"));
    EXPECT_EQ(report.skipped.lines, 1u);
    // Whether lines are skipped belongs to what is built.
    clean();
    ASSERT_TRUE(run_with_fault(words, work(), "kill", calls * 9 / 10).killed);
    EXPECT_THROW(build_tree({folder_ / "in.xyz"}, out(), options()), Error);
}

TEST_F(BuildFaults, PCM_NOT_UNDER_THREAD(ProgressSaysThatItResumes))
{
    interrupt(0.9);
    bool reported = false;
    BuildOptions with = options();
    with.progress = [&](const ProgressUpdate& update) {
        reported = reported || update.stage.find("interrupted") != std::string_view::npos;
        return true;
    };
    build_again(with);
    EXPECT_TRUE(reported);
}

// Whatever is torn, missing or too short: the tree is the same.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(BuildFaults, PCM_NOT_UNDER_SANITIZERS(WhatDoesNotHoldIsNotUsed))
{
    for (const double share : {0.4, 0.95}) {
        interrupt(share);
        const fs::path saved = folder_ / "saved";
        fs::copy(part(), saved, fs::copy_options::recursive);
        std::vector<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(saved))
            if (entry.is_regular_file() && entry.path().filename() != "building")
                files.push_back(fs::relative(entry.path(), saved));
        EXPECT_GE(files.size(), 4u);
        for (const fs::path& file : files)
            for (const char* harm : {"remove", "shorten", "empty"}) {
                clean();
                fs::copy(saved, part(), fs::copy_options::recursive);
                const std::uintmax_t size = fs::file_size(part() / file);
                if (harm == std::string("remove"))
                    fs::remove(part() / file);
                else
                    fs::resize_file(part() / file, harm == std::string("shorten") ? size / 2 : 0);
                build_again(options());
                EXPECT_TRUE(contents(out()) == reference_) << file << " " << harm;
            }
        // Bytes that changed: refused, or not looked at again.
        for (const fs::path& file : files) {
            clean();
            fs::copy(saved, part(), fs::copy_options::recursive);
            std::fstream bytes(part() / file, std::ios::in | std::ios::out | std::ios::binary);
            const auto middle = static_cast<std::streamoff>(fs::file_size(part() / file) / 2);
            bytes.seekg(middle);
            const char byte = static_cast<char>(~bytes.get());
            bytes.seekp(middle);
            bytes.put(byte);
            bytes.close();
            if (file.parent_path() == "tree" || file == "front.tmp")
                continue;  // chunks: pcmlab verify finds it by their checksums
            try {
                build_again(options());
            } catch (const Error& error) {
                EXPECT_NE(std::string(error.what()).find("out.pct.part"), std::string::npos) << error.what();
                EXPECT_TRUE(names_in(work()).empty());
                continue;
            }
            EXPECT_TRUE(contents(out()) == reference_) << file;
        }
        fs::remove_all(saved);
    }
}

// Where a system cannot exchange two folders, a crash can come between two renames.
TEST_F(BuildFaults, PCM_NOT_UNDER_THREAD(AReplacementThatWasCutOffIsPutBack))
{
    const auto cut_off = [&] {
        interrupt(0.9);
        fs::copy(folder_ / "reference.pct", part() / "old");
        ASSERT_TRUE(was_being_replaced(out()));
    };
    cut_off();
    try {
        Tree::open(out());
        ADD_FAILURE() << "opened";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::interrupted_build);
        EXPECT_NE(std::string(error.what()).find("repair"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(put_back_replaced(out()));
    EXPECT_TRUE(contents(out()) == reference_);
    EXPECT_FALSE(put_back_replaced(out()));

    // A build that must not overwrite puts it back too, and refuses.
    cut_off();
    EXPECT_THROW(build_tree({folder_ / "in.las"}, out(), options()), Error);
    EXPECT_TRUE(contents(out()) == reference_);
    // One that fails has put it back.
    cut_off();
    EXPECT_THROW(build_tree({folder_ / "in.las"}, out(),
                            [&] {
                                BuildOptions with = options();
                                with.overwrite = true;
                                with.progress = [](const ProgressUpdate&) { return false; };
                                return with;
                            }()),
                 Error);
    EXPECT_TRUE(contents(out()) == reference_);
    EXPECT_EQ(names_in(work()), std::vector<std::string>{"out.pct"});
}

}  // namespace
