#include "pcm/cli/mpi/mpi_team.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <chrono>
#include <string>

namespace pcm::cli {
namespace {

// Chosen: counts of MPI 3.1 are int, and messages of this size are as quick as larger ones.
constexpr std::uint64_t largest_message = std::uint64_t(1) << 28;
constexpr int ask_tag = 1, answer_tag = 2;

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

// Starts an operation, start(request), and sleeps until it is done.
template <class Start>
void MpiTeam::do_and_wait(const Start& start)
{
    MPI_Request request;
    {
        const std::lock_guard lock(mpi_mutex_);
        start(request);
    }
    constexpr int quick_tries = 20;
    const Clock::time_point begin = Clock::now();
    for (int tries = 0;; ++tries) {
        int done = 0;
        {
            const std::lock_guard lock(mpi_mutex_);
            check(MPI_Test(&request, &done, MPI_STATUS_IGNORE), "MPI_Test");
        }
        if (done) return;
        if (tries < quick_tries)
            std::this_thread::yield();
        else
            std::this_thread::sleep_for(next_pause(begin));
    }
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

void MpiTeam::connect(const std::vector<unsigned>& ranks)
{
    wait();  // what follows waits without sleeping
    const std::lock_guard lock(mpi_mutex_);
    if (neighbours_ != MPI_COMM_NULL) MPI_Comm_free(&neighbours_);
    std::vector<int> numbers(ranks.begin(), ranks.end());
    degree_ = numbers.size();
    numbers.push_back(0);  // so that there is an address
    check(MPI_Dist_graph_create_adjacent(comm_, static_cast<int>(degree_), numbers.data(), MPI_UNWEIGHTED,
                                         static_cast<int>(degree_), numbers.data(), MPI_UNWEIGHTED, MPI_INFO_NULL, 0,
                                         &neighbours_),
          "MPI_Dist_graph_create_adjacent");
}

std::vector<Team::Bytes> MpiTeam::exchange(std::vector<Bytes> bytes)
{
    std::vector<std::uint64_t> out(degree_ + 1), in(degree_ + 1);
    for (std::size_t n = 0; n < degree_; ++n) out[n] = bytes[n].size();
    do_and_wait([&](MPI_Request& request) {
        check(MPI_Ineighbor_alltoall(out.data(), 1, MPI_UINT64_T, in.data(), 1, MPI_UINT64_T, neighbours_, &request),
              "MPI_Ineighbor_alltoall");
    });
    std::vector<int> out_counts, out_places, in_counts, in_places;
    std::uint64_t out_size = 0, in_size = 0;
    for (std::size_t n = 0; n < degree_; ++n) {
        out_counts.push_back(static_cast<int>(out[n]));
        out_places.push_back(static_cast<int>(out_size));
        in_counts.push_back(static_cast<int>(in[n]));
        in_places.push_back(static_cast<int>(in_size));
        out_size += out[n];
        in_size += in[n];
    }
    if (std::max(out_size, in_size) >= std::uint64_t(1) << 31)
        throw Error(ErrorCode::unsupported, {}, "the points at the border of a rank's bins are more than 2 GiB",
                    "build with more ranks");
    Bytes sent, received(in_size + 1);
    sent.reserve(out_size + 1);
    for (const Bytes& of_rank : bytes) sent.insert(sent.end(), of_rank.begin(), of_rank.end());
    sent.push_back({});
    for (auto* counts : {&out_counts, &out_places, &in_counts, &in_places}) counts->push_back(0);
    do_and_wait([&](MPI_Request& request) {
        check(MPI_Ineighbor_alltoallv(sent.data(), out_counts.data(), out_places.data(), MPI_BYTE, received.data(),
                                      in_counts.data(), in_places.data(), MPI_BYTE, neighbours_, &request),
              "MPI_Ineighbor_alltoallv");
    });
    bytes_exchanged_ += out_size;
    std::vector<Bytes> all;
    for (std::size_t n = 0; n < degree_; ++n)
        all.emplace_back(received.begin() + in_places[n], received.begin() + in_places[n] + in_counts[n]);
    return all;
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
