#include "pcm/threads/in_turn.h"

#include "tests/support.h"

#include <atomic>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace {

using namespace pcm;

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
