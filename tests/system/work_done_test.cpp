#include "pcm/system/work_done.h"

#include "pcm/system/file.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

namespace {

TEST(WorkDone, IsCountedByAllThreads)
{
    const pcm::test::TemporaryFolder folder;
    std::ofstream(folder / "a") << std::string(1000, 'x');
    const pcm::WorkDone before = pcm::work_done();
    const auto read = [&] {
        const pcm::File file(folder / "a", pcm::File::Mode::read);
        char bytes[600];
        file.read_at(bytes, 600, 100);
        EXPECT_EQ(file.read_some_at(bytes, 600, 700), 300u) << "the file ends";
        pcm::count_points_read(7);
    };
    std::thread other(read);
    other.join();
    read();
    const pcm::WorkDone work = pcm::work_done() - before;
    EXPECT_EQ(work.bytes_read, 1800u);
    EXPECT_EQ(work.points_read, 14u);
}

TEST(WorkDone, TakesProcessorTime)
{
    const pcm::WorkDone before = pcm::work_done();
    double sum = 0;
    while ((pcm::work_done() - before).cpu_seconds < 0.02)
        for (int i = 0; i < 1000; ++i) sum += 1.0 / (i + 1);
    EXPECT_GT(sum, 0);
    EXPECT_LT((pcm::work_done() - before).cpu_seconds, 5);
}

}  // namespace
