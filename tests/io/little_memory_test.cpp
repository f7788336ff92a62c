// LAZ and E57 where the system gives little memory: an error, never the end of the process.

#include "tests/io/cloud_copy.h"
#include "tests/io/e57/e57_test.h"
#include "tests/io/las_file.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <new>
#include <system_error>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PCM_REQUIRE_LIMITS() GTEST_SKIP() << "a sanitizer needs all of the address space"
#else
#define PCM_REQUIRE_LIMITS() (void)0
#endif

namespace pcm::test {
namespace {

std::size_t address_space()
{
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

enum Ending { done = 0, no_memory = 1, other_error = 2 };

// How `work` ends in a process that gets `more` bytes of memory; negative: killed by that signal.
int in_little_memory(std::size_t more, const std::function<void()>& work)
{
    const pid_t child = fork();
    if (child == 0) {
        if (!std::freopen("/dev/null", "w", stderr)) _exit(other_error);
        rlimit limit{};
        limit.rlim_cur = limit.rlim_max = address_space() + more;
        setrlimit(RLIMIT_AS, &limit);
        try {
            work();
            _exit(done);
        } catch (const Error& error) {
            _exit(error.code() == ErrorCode::io ? no_memory : other_error);
        } catch (const std::bad_alloc&) {
            _exit(no_memory);
        } catch (const std::exception&) {
            _exit(other_error);
        }
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

// With each amount of memory, up to one that is enough, the work is done or fails for the lack of it.
void expect_errors_at_most(const std::function<void()>& work)
{
    constexpr std::size_t most = std::size_t(512) << 20;
    int failed = 0, succeeded = 0;
    for (std::size_t more = 0; more <= most && succeeded < 3; more += more < (4u << 20) ? 256u << 10 : more / 6) {
        const int ending = in_little_memory(more, work);
        EXPECT_TRUE(ending == done || ending == no_memory) << more << " bytes: " << ending;
        failed += ending == no_memory;
        succeeded += ending == done;
    }
    EXPECT_GT(failed, 0);
    EXPECT_GT(succeeded, 0);
}

void read_all(const std::filesystem::path& path, unsigned threads)
{
    ReadOptions options;
    options.threads = threads;
    const auto reader = open_reader(path, options);
    PointBatch batch;
    while (reader->read(batch, 10000)) {
    }
}

class LittleMemory : public testing::TestWithParam<int> {  // the point format
protected:
    void SetUp() override
    {
        if (!have_laz()) GTEST_SKIP() << "this build leaves LAZ out";
        PCM_REQUIRE_LIMITS();
        std::mt19937_64 random(3);
        const int format = GetParam();
        const auto las = random_las(random, format < 6 ? 2 : 4, format, 60000);
        cloud_ = read_whole(write_file(folder_ / "a.las", las.bytes()));
        write_cloud(folder_ / "a.laz", cloud_);
    }
    TemporaryFolder folder_;
    Whole cloud_;
};
INSTANTIATE_TEST_SUITE_P(Formats, LittleMemory, testing::Values(3, 7));

TEST_P(LittleMemory, ReadingLaz)
{
    for (const unsigned threads : {1u, 3u}) expect_errors_at_most([&] { read_all(folder_ / "a.laz", threads); });
}

TEST_P(LittleMemory, WritingLaz)
{
    for (const unsigned threads : {1u, 3u}) {
        WriteOptions options;
        options.threads = threads;
        expect_errors_at_most([&] { write_cloud(folder_ / "b.laz", cloud_, options); });
        EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 3);
    }
}

TEST_F(E57, InLittleMemory)
{
    PCM_REQUIRE_LIMITS();
    std::vector<E57TestScan> scans(200, simple_scan(20));
    const auto path = write_file(folder_ / "a.e57", e57_file(scans));
    expect_errors_at_most([&] { read_all(path, 1); });
}

}  // namespace
}  // namespace pcm::test
