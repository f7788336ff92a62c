#include "pcm/threads/ordered.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace {

using namespace pcm;

TEST(OrderedResults, TakesEachResultOnceInOrderWithTheLockReleased)
{
    std::mutex mutex;
    std::unique_lock lock(mutex);
    OrderedResults<int> results(3);
    std::vector<std::pair<std::size_t, int>> taken;
    const auto take = [&](std::size_t number, int result) {
        EXPECT_FALSE(lock.owns_lock());
        taken.emplace_back(number, result);
    };
    results.add(lock, 5, 50, take);
    results.add(lock, 4, 40, take);
    EXPECT_TRUE(taken.empty());
    EXPECT_EQ(results.next(), 3u);
    results.add(lock, 3, 30, take);
    EXPECT_TRUE(lock.owns_lock());
    EXPECT_EQ(results.next(), 6u);
    EXPECT_EQ(taken, (std::vector<std::pair<std::size_t, int>>{{3, 30}, {4, 40}, {5, 50}}));
}

TEST(OrderedResults, NothingIsTakenAfterAnError)
{
    std::mutex mutex;
    std::unique_lock lock(mutex);
    OrderedResults<int> results;
    EXPECT_THROW(results.add(lock, 0, 0, [](std::size_t, int) { throw std::runtime_error("taken"); }),
                 std::runtime_error);
    if (!lock.owns_lock()) lock.lock();
    results.add(lock, 1, 1, [](std::size_t, int) { FAIL(); });
    EXPECT_EQ(results.next(), 0u);
}

TEST(InTurn, TakesResultsInOrder)
{
    for (const unsigned threads : {0u, 1u, 2u, 7u})
        for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
            std::vector<std::size_t> taken;
            std::atomic<std::size_t> made{0};
            std::size_t ahead = 0;
            in_turn(
                count, threads,
                [&](std::size_t i) {
                    ++made;
                    return std::make_unique<std::size_t>(i * i);
                },
                [&](std::size_t i, std::unique_ptr<std::size_t> result) {
                    EXPECT_EQ(*result, i * i);
                    taken.push_back(i);
                    ahead = std::max(ahead, made.load() - taken.size());
                },
                [](std::size_t) {});
            std::vector<std::size_t> all(count);
            std::iota(all.begin(), all.end(), 0u);
            EXPECT_EQ(taken, all);
            EXPECT_LE(ahead, 3 * std::size_t(std::max(1u, threads)));
        }
}

TEST(InTurn, TheFirstErrorEndsAll)
{
    for (const bool making : {true, false})
        EXPECT_THROW(in_turn(
                         1000, 3,
                         [&](std::size_t i) {
                             if (making && i == 500) throw std::runtime_error("made");
                             return i;
                         },
                         [&](std::size_t i, std::size_t) {
                             if (!making && i == 500) throw std::runtime_error("taken");
                         },
                         [](std::size_t) {}),
                     std::runtime_error);
}

}  // namespace
