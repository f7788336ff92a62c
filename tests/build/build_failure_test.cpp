// Builds that cannot be done, are cancelled or killed: what they report, and what they leave behind.

#include "pcm/build/builder.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/verify.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

ErrorCode code_of(const std::function<void()>& f, const std::string& must_name)
{
    try {
        f();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(must_name), std::string::npos) << error.what();
        return error.code();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorCode::io;
}

TEST(BuildFailure, NothingIsOverwrittenUnasked)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 100, 1), {});
    build_tree({folder / "in.las"}, folder / "out.pct", small_chunks());
    EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "out.pct", small_chunks()); }, "out.pct"),
              ErrorCode::exists);
    // With overwrite, only a tree is.
    fs::create_directory(folder / "precious");
    std::ofstream(folder / "precious" / "thesis.txt") << "years of work";
    BuildOptions options = small_chunks();
    options.overwrite = true;
    EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "precious", options); }, "precious"),
              ErrorCode::exists);
    EXPECT_TRUE(fs::exists(folder / "precious" / "thesis.txt"));
    // Nor is a folder that happens to be called like the one a build works in.
    fs::create_directory(folder / "new.pct.part");
    std::ofstream(folder / "new.pct.part" / "thesis.txt") << "years of work";
    EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "new.pct", options); }, "new.pct.part"),
              ErrorCode::exists);
    EXPECT_TRUE(fs::exists(folder / "new.pct.part" / "thesis.txt"));
}

TEST(BuildFailure, BadInputLeavesNothingBehind)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 1000, 1), {});
    fs::resize_file(folder / "in.las", 227 + 26 * 500);
    EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "out.pct", small_chunks()); }, "in.las"),
              ErrorCode::truncated);
    EXPECT_EQ(code_of([&] { build_tree({folder / "no.las"}, folder / "out.pct", small_chunks()); }, "no.las"),
              ErrorCode::not_found);
    EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "no" / "out.pct", small_chunks()); }, "in.las"),
              ErrorCode::truncated);
    EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"in.las"});
}

TEST(BuildFailure, CancelLeavesNothingBehind)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, tries(1000000, 200000), 1), {});
    for (const double at : {0.0, 0.2, 0.5, 0.9}) {
        BuildOptions options = small_chunks();
        options.progress = [&](const ProgressUpdate& update) { return update.fraction < at; };
        EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "out.pct", options); }, "cancelled"),
                  ErrorCode::cancelled);
        EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"in.las"});
    }
}

// Runs `f` in a child process; returns its exit status.
int in_child(const std::function<int()>& f)
{
    const pid_t child = fork();
    if (child == 0) _exit(f());
    int status = 0;
    waitpid(child, &status, 0);
    return status;
}

// A disk that is full after `limit` bytes of one file: the system's own limit on file sizes gives the same kind of
// error.
TEST(BuildFailure, AFullDiskIsNamedAndLeavesNothingBehind)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 300000, 1), {});
    for (const rlim_t limit : {1u << 16, 1u << 20, 1u << 22}) {
        const int status = in_child([&] {
            signal(SIGXFSZ, SIG_IGN);
            const rlimit file_size{limit, limit};
            setrlimit(RLIMIT_FSIZE, &file_size);
            try {
                build_tree({folder / "in.las"}, folder / "out.pct", small_chunks());
            } catch (const Error& error) {
                return error.code() == ErrorCode::no_space &&
                               std::string(error.what()).find("out.pct") != std::string::npos
                           ? 42
                           : 1;
            }
            return 2;
        });
        EXPECT_EQ(WEXITSTATUS(status), 42) << limit;
        EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"in.las"});
    }
}

TEST(BuildFailure, NoPermission)
{
    const TemporaryFolder folder;
    const fs::perms look = fs::perms(0555);
    fs::permissions(folder.path(), fs::perms::owner_all | look);
    write_las(folder / "in.las", records(Shape::surface, 1000, 1), {});
    fs::create_directory(folder / "locked");
    fs::permissions(folder / "locked", look);
    const int status = in_child([&] {
        // Root may write everywhere: be somebody else.
        if (geteuid() == 0 && setuid(65534) != 0) return 3;
        try {
            build_tree({folder / "in.las"}, folder / "locked" / "out.pct", small_chunks());
        } catch (const Error& error) {
            return error.code() == ErrorCode::permission &&
                           std::string(error.what()).find("locked") != std::string::npos
                       ? 42
                       : 1;
        }
        return 2;
    });
    EXPECT_EQ(WEXITSTATUS(status), 42);
    EXPECT_TRUE(names_in(folder / "locked").empty());
}

// Killed at many moments: there is no tree, or there is the whole tree; and building again works and gives the same
// bytes.
TEST(BuildFailure, KilledAnywhereItIsNeverTakenForATree)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 150000, 1), {});
    build_tree({folder / "in.las"}, folder / "reference.pct", small_chunks());
    const auto reference = contents(folder / "reference.pct");
    int killed = 0, interrupted = 0;
    for (int delay_us = 500; delay_us < 400000; delay_us = delay_us * 5 / 4) {
        const pid_t child = fork();
        if (child == 0) {
            try {
                build_tree({folder / "in.las"}, folder / "out.pct", small_chunks());
            } catch (...) {
                _exit(1);
            }
            _exit(0);
        }
        usleep(static_cast<useconds_t>(delay_us));
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        killed += WIFSIGNALED(status);
        if (fs::exists(folder / "out.pct")) {
            EXPECT_TRUE(contents(folder / "out.pct") == reference);
            fs::remove_all(folder / "out.pct");
        } else {
            EXPECT_EQ(code_of([&] { Tree::open(folder / "out.pct"); }, "out.pct"), ErrorCode::not_found);
            if (fs::exists(folder / "out.pct.part" / "building")) {
                ++interrupted;
                if (!fs::exists(folder / "out.pct.part" / index_file_name))
                    EXPECT_EQ(code_of([&] { Tree::open(folder / "out.pct.part"); }, "interrupted"),
                              ErrorCode::interrupted_build);
            }
        }
    }
    EXPECT_GT(killed, 3);
    EXPECT_GT(interrupted, 1);
    build_tree({folder / "in.las"}, folder / "out.pct", small_chunks());
    EXPECT_TRUE(contents(folder / "out.pct") == reference);
    EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"in.las", "out.pct", "reference.pct"}));
}

TEST(BuildFailure, TwoBuildsOfOneTree)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 300000, 1), {});
    BuildOptions options = small_chunks();
    bool tried = false;
    options.progress = [&](const ProgressUpdate&) {
        if (!tried) {
            tried = true;
            EXPECT_EQ(
                code_of([&] { build_tree({folder / "in.las"}, folder / "out.pct", small_chunks()); }, "another build"),
                ErrorCode::exists);
        }
        return true;
    };
    build_tree({folder / "in.las"}, folder / "out.pct", options);
    EXPECT_TRUE(tried);
    EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
}

TEST(BuildFailure, OptionsOutOfRange)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 10, 1), {});
    BuildOptions options = small_chunks();
    options.memory_bytes = 1000;
    EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "o.pct", options); }, "64 MiB"),
              ErrorCode::invalid_argument);
    options = small_chunks(10);
    EXPECT_EQ(code_of([&] { build_tree({folder / "in.las"}, folder / "o.pct", options); }, "1000"),
              ErrorCode::invalid_argument);
}

}  // namespace
