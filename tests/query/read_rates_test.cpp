// Times of reads, predicted from those that were measured.
#include "pcm/query/read_rates.h"

#include "tests/support.h"

#include <random>

namespace {

using namespace pcm;

TEST(ReadRates, AreALineThroughTheReads)
{
    ReadRates rates;
    EXPECT_FALSE(rates.seconds(1, 1000));
    for (int i = 0; i < 100; ++i) {
        const std::uint64_t bytes = 1000 + 777 * (i % 13);
        rates.add_read(bytes, 0.002 + 1e-6 * double(bytes));
    }
    EXPECT_NEAR(*rates.seconds(1, 5000), 0.002 + 0.005, 1e-9);
    EXPECT_NEAR(*rates.seconds(10, 5000), 0.020 + 0.005, 1e-9);
    EXPECT_NEAR(*rates.seconds(0, 5000), 0.005, 1e-9);
    // Twice as slow from now on: after a few hundred reads that is what counts.
    for (int i = 0; i < 1500; ++i) {
        const std::uint64_t bytes = 1000 + 777 * (i % 13);
        rates.add_read(bytes, 0.004 + 2e-6 * double(bytes));
    }
    EXPECT_NEAR(*rates.seconds(1, 5000), 0.004 + 0.010, 1e-4);
}

TEST(ReadRates, OfReadsOfOneSizeAllTimeIsTheBytes)
{
    ReadRates one_size, none, falling;
    for (int i = 0; i < 20; ++i) {
        one_size.add_read(2000, i % 2 ? 0.003 : 0.005);
        none.add_read(0, 0.004);
        falling.add_read(1000 + 100 * std::uint64_t(i), 0.01 - 0.0001 * i);  // larger reads were faster
    }
    EXPECT_NEAR(*one_size.seconds(7, 2000), 0.004, 2e-5);
    EXPECT_NEAR(*one_size.seconds(1, 4000), 0.008, 4e-5);
    EXPECT_NEAR(*none.seconds(3, 0), 0.012, 1e-9);
    EXPECT_GT(*falling.seconds(1, 4000), 1.9 * *falling.seconds(1, 2000));
    EXPECT_EQ(*falling.seconds(5, 0), 0);
}

TEST(ReadRates, WaitsAreThoseThatParallelReadsLeave)
{
    ReadRates rates;
    for (int i = 0; i < 50; ++i) rates.add_read(1000 + 100 * std::uint64_t(i), 0.001 + 1e-6 * (1000 + 100 * i));
    const double work = *rates.seconds(1, 9000);
    rates.add_wait(0, 5);  // a wait without reads
    EXPECT_EQ(*rates.seconds(1, 9000), work);
    for (int i = 0; i < 10; ++i) rates.add_wait(1, 0.25);
    EXPECT_NEAR(*rates.seconds(1, 9000), work / 4, 1e-9);
    for (int i = 0; i < 200; ++i) rates.add_wait(1, 3);  // it waited for others too
    EXPECT_NEAR(*rates.seconds(1, 9000), work, 1e-6 * work);
    // Earlier reads and waits count nine tenths.
    ReadRates two;
    two.add_read(1000, 1);
    two.add_wait(1, 1);
    two.add_wait(1, 0);
    EXPECT_NEAR(*two.seconds(1, 1000), 0.9 / 1.9, 1e-9);
}

}  // namespace
