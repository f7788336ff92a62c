// A team whose ranks are threads of one process.
#pragma once

#include "pcm/system/error.h"
#include "pcm/threads/team.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace pcm::test {

class ThreadTeams {
public:
    explicit ThreadTeams(unsigned size) : given_(size), neighbours_(size) {}

    // Calls work(team) in each rank. Throws the exception of the lowest rank that failed by itself.
    void run(const std::function<void(Team&)>& work)
    {
        std::vector<std::exception_ptr> errors(given_.size());
        std::vector<std::thread> threads;
        for (unsigned r = 0; r < given_.size(); ++r)
            threads.emplace_back([&, r] {
                Rank team(*this, r);
                try {
                    work(team);
                } catch (const Ended&) {
                } catch (...) {
                    errors[r] = std::current_exception();
                    end();
                }
            });
        for (std::thread& thread : threads) thread.join();
        for (const std::exception_ptr& error : errors)
            if (error) std::rethrow_exception(error);
    }

    // Whoever takes a number of this counter fails.
    void fail_at(std::uint64_t counter) { fails_at_ = counter; }

    std::uint64_t bytes_exchanged() const { return bytes_exchanged_; }
    std::uint64_t exchanges() const { return exchanges_; }

private:
    struct Ended {};  // another rank has failed

    // Each rank gives something, then all take what they need of it.
    template <class Take>
    auto meet(unsigned rank, std::vector<Team::Bytes> mine, const Take& take)
    {
        std::unique_lock lock(mutex_);
        given_[rank] = std::move(mine);
        step(lock);
        auto taken = take(given_);
        step(lock);
        return taken;
    }
    void step(std::unique_lock<std::mutex>& lock)
    {
        const std::uint64_t now = steps_;
        if (++here_ == given_.size()) {
            here_ = 0;
            ++steps_;
            wake_.notify_all();
        }
        wake_.wait(lock, [&] { return ended_ || steps_ != now; });
        if (ended_) throw Ended();
    }

    class Rank final : public Team {
    public:
        Rank(ThreadTeams& all, unsigned rank) : all_(all), rank_(rank) {}
        unsigned rank() const override { return rank_; }
        unsigned size() const override { return static_cast<unsigned>(all_.given_.size()); }
        Bytes broadcast(unsigned from, Bytes bytes) override
        {
            return all_.meet(rank_, {std::move(bytes)}, [&](const auto& given) { return given[from][0]; });
        }
        std::vector<Bytes> gather(Bytes bytes) override
        {
            return all_.meet(rank_, {std::move(bytes)}, [](const auto& given) {
                std::vector<Bytes> all;
                for (const auto& of_rank : given) all.push_back(of_rank[0]);
                return all;
            });
        }
        void connect(const std::vector<unsigned>& ranks) override
        {
            all_.neighbours_[rank_] = ranks;
            wait();
        }
        std::vector<Bytes> exchange(std::vector<Bytes> bytes) override
        {
            const std::vector<unsigned>& with = all_.neighbours_[rank_];
            if (bytes.size() != with.size()) throw Error(ErrorCode::invalid_argument, {}, "not one for each neighbour");
            for (const Bytes& of_rank : bytes) all_.bytes_exchanged_ += of_rank.size();
            ++all_.exchanges_;
            return all_.meet(rank_, std::move(bytes), [&](const auto& given) {
                std::vector<Bytes> all;
                for (const unsigned other : with) {
                    const std::vector<unsigned>& its = all_.neighbours_[other];
                    const auto place = std::find(its.begin(), its.end(), rank_);
                    if (place == its.end()) throw Error(ErrorCode::invalid_argument, {}, "a neighbour of one side");
                    all.push_back(given[other][static_cast<std::size_t>(place - its.begin())]);
                }
                return all;
            });
        }
        std::uint64_t next(std::uint64_t counter) override
        {
            const std::lock_guard lock(all_.mutex_);
            if (all_.ended_) throw Ended();
            if (counter == all_.fails_at_) throw Error(ErrorCode::io, {}, "the disk is gone");
            return all_.counters_[counter]++;
        }

    private:
        ThreadTeams& all_;
        const unsigned rank_;
    };

    void end()
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
        wake_.notify_all();
    }

    std::mutex mutex_;
    std::condition_variable wake_;
    std::vector<std::vector<Team::Bytes>> given_;
    std::vector<std::vector<unsigned>> neighbours_;
    std::map<std::uint64_t, std::uint64_t> counters_;
    std::atomic<std::uint64_t> bytes_exchanged_{0}, exchanges_{0};
    std::optional<std::uint64_t> fails_at_;
    std::size_t here_ = 0;
    std::uint64_t steps_ = 0;
    bool ended_ = false;
};

}  // namespace pcm::test
