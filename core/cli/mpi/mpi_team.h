// A team of MPI processes.
//
// MPI 3.1, by its C functions. Waiting sleeps, for a tenth of the time waited so far: a rank that has nothing to do
// costs its machine no processor time worth mention, and notices what it waits for a tenth too late at most. All calls
// of MPI are made under one mutex, so that MPI_THREAD_SERIALIZED is enough.
#pragma once

#include "pcm/threads/team.h"

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include <mpi.h>

namespace pcm::cli {

class MpiTeam final : public Team {
public:
    // One in a process, between MPI_Init_thread() and MPI_Finalize(). Collective.
    MpiTeam();
    // Not collective: the process may be about to call MPI_Abort().
    ~MpiTeam() override;

    unsigned rank() const override { return static_cast<unsigned>(rank_); }
    unsigned size() const override { return static_cast<unsigned>(size_); }
    unsigned ranks_of_machine() const { return static_cast<unsigned>(ranks_of_machine_); }

    Bytes broadcast(unsigned from, Bytes bytes) override;
    std::vector<Bytes> gather(Bytes bytes) override;
    void connect(const std::vector<unsigned>& ranks) override { neighbours_.assign(ranks.begin(), ranks.end()); }
    std::vector<Bytes> exchange(std::vector<Bytes> bytes) override;
    std::uint64_t next(std::uint64_t counter) override;

    // What this rank has sent its neighbours by exchange().
    std::uint64_t bytes_exchanged() const { return bytes_exchanged_; }

private:
    template <class Start>
    void do_and_wait(std::size_t operations, const Start& start);
    template <class Start>
    void do_and_wait(const Start& start);
    void serve_counters();
    bool answer_one();  // false where nobody asks
    std::uint64_t count(std::uint64_t counter);

    int rank_ = 0, size_ = 1, ranks_of_machine_ = 1;
    MPI_Comm comm_ = MPI_COMM_NULL, counter_comm_ = MPI_COMM_NULL;
    std::vector<int> neighbours_;
    std::uint64_t bytes_exchanged_ = 0;
    std::mutex mpi_mutex_, ask_mutex_, counters_mutex_;
    // Rank 0's, under counters_mutex_.
    std::map<std::uint64_t, std::uint64_t> counters_;
    std::chrono::steady_clock::time_point last_count_{};
    bool ended_ = false;
    std::condition_variable counted_;
    std::thread server_;  // rank 0's: answers the others' next()
};

}  // namespace pcm::cli
