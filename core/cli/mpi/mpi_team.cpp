#include "pcm/cli/mpi/mpi_team.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <chrono>
#include <string>

namespace pcm::cli {
namespace {

// Chosen: counts of MPI 3.1 are int, and messages of this size are as quick as larger ones.
constexpr std::uint64_t largest_message = std::uint64_t(1) << 28;
constexpr int ask_tag = 1, answer_tag = 2, size_tag = 3, bytes_tag = 4;

using Clock = std::chrono::steady_clock;

// Chosen: a tenth of the wait, so that a wait of a second is noticed by some 80 calls of MPI; the shortest pause is
// what Linux rounds timers to, and the longest lets ranks that wait for minutes use a thousandth of a processor.
std::chrono::nanoseconds next_pause(Clock::time_point begin)
{
    return std::clamp<std::chrono::nanoseconds>((Clock::now() - begin) / 10, std::chrono::microseconds(50),
                                                std::chrono::milliseconds(10));
}

void check(int result, const char* what)
{
    if (result != MPI_SUCCESS) throw Error(ErrorCode::io, {}, std::string("MPI failed: ") + what);
}

std::size_t messages_of(std::uint64_t bytes) { return (bytes + largest_message - 1) / largest_message; }

}  // namespace

MpiTeam::MpiTeam()
{
    check(MPI_Comm_dup(MPI_COMM_WORLD, &comm_), "MPI_Comm_dup");
    check(MPI_Comm_dup(MPI_COMM_WORLD, &counter_comm_), "MPI_Comm_dup");
    check(MPI_Comm_rank(comm_, &rank_), "MPI_Comm_rank");
    check(MPI_Comm_size(comm_, &size_), "MPI_Comm_size");
    MPI_Comm machine;
    check(MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine), "MPI_Comm_split_type");
    check(MPI_Comm_size(machine, &ranks_of_machine_), "MPI_Comm_size");
    MPI_Comm_free(&machine);
    if (rank_ == 0 && size_ > 1) server_ = std::thread([this] { serve_counters(); });
}

MpiTeam::~MpiTeam()
{
    {
        const std::lock_guard lock(counters_mutex_);
        ended_ = true;
    }
    counted_.notify_all();
    if (server_.joinable()) server_.join();
}

// Starts operations, start(requests), and sleeps until all of them are done.
template <class Start>
void MpiTeam::do_and_wait(std::size_t operations, const Start& start)
{
    std::vector<MPI_Request> requests(operations, MPI_REQUEST_NULL);
    {
        const std::lock_guard lock(mpi_mutex_);
        start(requests.data());
    }
    constexpr int quick_tries = 3;
    const Clock::time_point begin = Clock::now();
    for (int tries = 0;; ++tries) {
        int done = 0;
        {
            const std::lock_guard lock(mpi_mutex_);
            check(MPI_Testall(static_cast<int>(operations), requests.data(), &done, MPI_STATUSES_IGNORE),
                  "MPI_Testall");
        }
        if (done) return;
        if (tries < quick_tries)
            std::this_thread::yield();
        else
            std::this_thread::sleep_for(next_pause(begin));
    }
}

template <class Start>
void MpiTeam::do_and_wait(const Start& start)
{
    do_and_wait(1, [&](MPI_Request* request) { start(*request); });
}

Team::Bytes MpiTeam::broadcast(unsigned from, Bytes bytes)
{
    std::uint64_t size = bytes.size();
    do_and_wait([&](MPI_Request& request) {
        check(MPI_Ibcast(&size, 1, MPI_UINT64_T, static_cast<int>(from), comm_, &request), "MPI_Ibcast");
    });
    bytes.resize(size);
    for (std::uint64_t at = 0; at < size; at += largest_message) {
        const auto count = static_cast<int>(std::min(largest_message, size - at));
        do_and_wait([&](MPI_Request& request) {
            check(MPI_Ibcast(bytes.data() + at, count, MPI_BYTE, static_cast<int>(from), comm_, &request),
                  "MPI_Ibcast");
        });
    }
    return bytes;
}

std::vector<Team::Bytes> MpiTeam::gather(Bytes bytes)
{
    const std::uint64_t mine = bytes.size();
    std::vector<std::uint64_t> sizes(size());
    do_and_wait([&](MPI_Request& request) {
        check(MPI_Iallgather(&mine, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, comm_, &request), "MPI_Iallgather");
    });
    std::uint64_t sum = 0;
    for (const std::uint64_t of_rank : sizes) sum += of_rank;
    std::vector<Bytes> all(size());
    if (sum > largest_message) {
        for (unsigned r = 0; r < size(); ++r) all[r] = broadcast(r, r == rank() ? std::move(bytes) : Bytes());
        return all;
    }
    if (sum == 0) return all;
    std::vector<int> counts, places;
    int place = 0;
    for (const std::uint64_t of_rank : sizes) {
        counts.push_back(static_cast<int>(of_rank));
        places.push_back(place);
        place += counts.back();
    }
    Bytes together(sum);
    do_and_wait([&](MPI_Request& request) {
        check(MPI_Iallgatherv(bytes.data(), static_cast<int>(mine), MPI_BYTE, together.data(), counts.data(),
                              places.data(), MPI_BYTE, comm_, &request),
              "MPI_Iallgatherv");
    });
    for (unsigned r = 0; r < size(); ++r)
        all[r].assign(together.begin() + places[r], together.begin() + places[r] + counts[r]);
    return all;
}

// Messages to and from neighbours, not MPI_Neighbor_alltoallv(): its communicator can only be made by a call that waits
// without sleeping, and counts of its bytes end at 2 GiB.
std::vector<Team::Bytes> MpiTeam::exchange(std::vector<Bytes> bytes)
{
    const std::size_t degree = neighbours_.size();
    std::vector<std::uint64_t> out(degree), in(degree);
    for (std::size_t n = 0; n < degree; ++n) out[n] = bytes[n].size();
    do_and_wait(2 * degree, [&](MPI_Request* requests) {
        for (std::size_t n = 0; n < degree; ++n) {
            check(MPI_Irecv(&in[n], 1, MPI_UINT64_T, neighbours_[n], size_tag, comm_, requests++), "MPI_Irecv");
            check(MPI_Isend(&out[n], 1, MPI_UINT64_T, neighbours_[n], size_tag, comm_, requests++), "MPI_Isend");
        }
    });
    std::vector<Bytes> received(degree);
    std::size_t messages = 0;
    for (std::size_t n = 0; n < degree; ++n) {
        received[n].resize(in[n]);
        messages += messages_of(in[n]) + messages_of(out[n]);
        bytes_exchanged_ += out[n];
    }
    do_and_wait(messages, [&](MPI_Request* requests) {
        for (std::size_t n = 0; n < degree; ++n) {
            for (std::uint64_t at = 0; at < in[n]; at += largest_message)
                check(MPI_Irecv(received[n].data() + at, static_cast<int>(std::min(largest_message, in[n] - at)),
                                MPI_BYTE, neighbours_[n], bytes_tag, comm_, requests++),
                      "MPI_Irecv");
            for (std::uint64_t at = 0; at < out[n]; at += largest_message)
                check(MPI_Isend(bytes[n].data() + at, static_cast<int>(std::min(largest_message, out[n] - at)),
                                MPI_BYTE, neighbours_[n], bytes_tag, comm_, requests++),
                      "MPI_Isend");
        }
    });
    return received;
}

std::uint64_t MpiTeam::count(std::uint64_t counter)
{
    const std::lock_guard lock(counters_mutex_);
    last_count_ = Clock::now();
    counted_.notify_all();  // the others are likely to ask now
    return counters_[counter]++;
}

std::uint64_t MpiTeam::next(std::uint64_t counter)
{
    if (rank_ == 0) return count(counter);
    const std::lock_guard one_at_a_time(ask_mutex_);
    std::uint64_t answer = 0;
    do_and_wait([&](MPI_Request& request) {
        check(MPI_Isend(&counter, 1, MPI_UINT64_T, 0, ask_tag, counter_comm_, &request), "MPI_Isend");
    });
    do_and_wait([&](MPI_Request& request) {
        check(MPI_Irecv(&answer, 1, MPI_UINT64_T, 0, answer_tag, counter_comm_, &request), "MPI_Irecv");
    });
    return answer;
}

void MpiTeam::serve_counters()
{
    std::unique_lock lock(counters_mutex_);
    while (!ended_) {
        lock.unlock();
        const bool answered = answer_one();
        lock.lock();
        if (!answered) counted_.wait_for(lock, next_pause(last_count_));
    }
}

bool MpiTeam::answer_one()
{
    const std::lock_guard lock(mpi_mutex_);
    int asked = 0;
    MPI_Status status;
    check(MPI_Iprobe(MPI_ANY_SOURCE, ask_tag, counter_comm_, &asked, &status), "MPI_Iprobe");
    if (!asked) return false;
    std::uint64_t counter = 0;
    check(MPI_Recv(&counter, 1, MPI_UINT64_T, status.MPI_SOURCE, ask_tag, counter_comm_, MPI_STATUS_IGNORE),
          "MPI_Recv");
    const std::uint64_t number = count(counter);
    check(MPI_Send(&number, 1, MPI_UINT64_T, status.MPI_SOURCE, answer_tag, counter_comm_), "MPI_Send");
    return true;
}

}  // namespace pcm::cli
