#include "pcm/system/work_done.h"

#include <sys/resource.h>

#include <atomic>

namespace pcm {
namespace {

std::atomic<std::uint64_t> points_read{0}, bytes_read{0}, reads{0}, requests{0}, bytes_received{0};

double seconds_of(const timeval& time)
{
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

WorkDone work_done()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return {seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
            points_read.load(std::memory_order_relaxed),
            bytes_read.load(std::memory_order_relaxed),
            reads.load(std::memory_order_relaxed),
            requests.load(std::memory_order_relaxed),
            bytes_received.load(std::memory_order_relaxed)};
}

WorkDone operator-(const WorkDone& after, const WorkDone& before)
{
    return {after.cpu_seconds - before.cpu_seconds, after.points_read - before.points_read,
            after.bytes_read - before.bytes_read,   after.reads - before.reads,
            after.requests - before.requests,       after.bytes_received - before.bytes_received};
}

void count_points_read(std::uint64_t points) { points_read.fetch_add(points, std::memory_order_relaxed); }
void count_read(std::uint64_t bytes)
{
    bytes_read.fetch_add(bytes, std::memory_order_relaxed);
    reads.fetch_add(1, std::memory_order_relaxed);
}
void count_request(std::uint64_t bytes)
{
    bytes_received.fetch_add(bytes, std::memory_order_relaxed);
    requests.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace pcm
