// A team whose work is interfered with at a step of it.
#pragma once

#include "pcm/threads/team.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace pcm::test {

// A team of one that counts the calls of its functions, and calls `action` before one of them.
class CountingTeam final : public Team {
public:
    explicit CountingTeam(std::size_t at = ~std::size_t(0), std::function<void()> action = {})
        : at_(at), action_(std::move(action))
    {
    }
    std::size_t calls() const { return calls_; }

    unsigned rank() const override { return 0; }
    unsigned size() const override { return 1; }
    Bytes broadcast(unsigned from, Bytes bytes) override
    {
        count();
        return team_.broadcast(from, std::move(bytes));
    }
    std::vector<Bytes> gather(Bytes bytes) override
    {
        count();
        return team_.gather(std::move(bytes));
    }
    void connect(const std::vector<unsigned>& ranks) override { team_.connect(ranks); }
    std::vector<Bytes> exchange(std::vector<Bytes> bytes) override { return team_.exchange(std::move(bytes)); }
    std::uint64_t next(std::uint64_t counter) override
    {
        count();
        return team_.next(counter);
    }

private:
    void count()
    {
        if (calls_++ == at_) action_();
    }

    SoloTeam team_;
    const std::size_t at_;
    const std::function<void()> action_;
    std::size_t calls_ = 0;
};

}  // namespace pcm::test
