// Processes that do one operation together, and what they send each other.
//
// Each has a rank, 0 .. size - 1. Collective functions are called by all ranks in the same order, by one thread of each
// at a time, and wait for one another. A rank that fails ends the whole team: the others' calls do not return, or throw
// Error(cancelled).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace pcm {

class Team {
public:
    using Bytes = std::vector<std::byte>;

    Team() = default;
    virtual ~Team() = default;
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    virtual unsigned rank() const = 0;
    virtual unsigned size() const = 0;

    // Collective: the bytes that rank `from` gave.
    virtual Bytes broadcast(unsigned from, Bytes bytes) = 0;
    // Collective: what every rank gave, by rank.
    virtual std::vector<Bytes> gather(Bytes bytes) = 0;
    // Collective: from now on exchange() is with these other ranks, ascending, each of which names this one.
    virtual void connect(const std::vector<unsigned>& ranks) = 0;
    // Collective: gives each of the ranks of connect() its bytes, in their order, and returns what they gave.
    virtual std::vector<Bytes> exchange(std::vector<Bytes> bytes) = 0;
    // The next number of a counter that all ranks share, from 0. Any thread, at any time.
    virtual std::uint64_t next(std::uint64_t counter) = 0;

    // Collective: returns when all ranks are here.
    void wait() { gather({}); }
};

// A team of this process alone.
class SoloTeam final : public Team {
public:
    unsigned rank() const override { return 0; }
    unsigned size() const override { return 1; }
    Bytes broadcast(unsigned, Bytes bytes) override { return bytes; }
    std::vector<Bytes> gather(Bytes bytes) override
    {
        std::vector<Bytes> all;
        all.push_back(std::move(bytes));
        return all;
    }
    void connect(const std::vector<unsigned>&) override {}
    std::vector<Bytes> exchange(std::vector<Bytes>) override { return {}; }
    std::uint64_t next(std::uint64_t counter) override
    {
        const std::lock_guard lock(mutex_);
        return counters_[counter]++;
    }

private:
    std::mutex mutex_;
    std::map<std::uint64_t, std::uint64_t> counters_;
};

}  // namespace pcm
