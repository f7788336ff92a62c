// Arrays on a disk that is full, and in a process that is killed.

#include "pcm/bpc/bpc_array.h"

#include "pcm/bpc/bpc_file.h"
#include "pcm/system/error.h"
#include "tests/bpc/array_rows.h"
#include "tests/support.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <random>

namespace pcm {
namespace {

using namespace test;

// A full disk (a limit on file sizes) loses nothing: neither the file nor the changes.
TEST(BpcArray, AFailedFlushLeavesBothAsTheyWere)
{
    TemporaryFolder folder;
    const auto path = folder / "a.bpc";
    write_numbered(path, 20000, 1000);
    BpcArray array(path);
    const Columns columns(array);
    std::mt19937_64 random(5);
    for (auto point : array) point.set(columns.time, static_cast<double>(random()));
    const auto bytes = std::filesystem::file_size(path);
    rlimit old;
    getrlimit(RLIMIT_FSIZE, &old);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{bytes / 2, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    EXPECT_THROW(array.flush(), Error);
    setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(files_in(folder.path()), 1u);
    BpcArray untouched(path);
    EXPECT_EQ(untouched.get(777, columns.time), 777);
    array.flush();
    random.seed(5);
    BpcArray changed(path);
    for (auto point : changed) ASSERT_EQ(point.get(columns.time), static_cast<double>(random()));
}

// A process that changes all points and flushes, over and over, is killed at many instants: the file is undamaged, all
// its points are of the same flush, and that flush is not older than one that was read before.
TEST(BpcArray, KilledAtAnyInstantTheOldOrTheNew)
{
    TemporaryFolder folder;
    const auto path = folder / "a.bpc";
    write_numbered(path, 3000, 500);
    {
        BpcArray array(path);
        const Columns columns(array);
        for (auto point : array) point.set(columns.time, 0);
        array.flush();
    }
    std::mt19937_64 random(6);
    double newest = 0;
    for (int round = 0; round < 40; ++round) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            try {
                BpcArrayOptions options;
                options.read_ahead = false;
                options.chunk_points = 500;
                BpcArray array(path, options);
                const Columns columns(array);
                for (double value = array.get(0, columns.time) + 1;; ++value) {
                    for (auto point : array) point.set(columns.time, value);
                    array.flush();
                }
            } catch (...) {
                _exit(1);
            }
        }
        usleep(static_cast<useconds_t>(random() % 30000));
        kill(child, SIGKILL);
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFSIGNALED(status)) << "the child failed by itself";
        BpcArray array(path);
        const Columns columns(array);
        ASSERT_EQ(array.size(), 3000u);
        const double value = array.get(0, columns.time);
        EXPECT_GE(value, newest);

        newest = value;
        for (auto point : array) {
            ASSERT_EQ(point.get(columns.time), value) << "points of two flushes in one file";
            ASSERT_EQ(point.get(columns.intensity), static_cast<std::uint16_t>(point.index()));
        }
    }
}

}  // namespace
}  // namespace pcm
