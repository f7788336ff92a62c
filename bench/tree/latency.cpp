// A disk far away: loaded before a program (LD_PRELOAD), every read of a file below PCM_LATENCY_UNDER waits
// PCM_LATENCY_MS, and its bytes come at PCM_LATENCY_MBS megabytes a second over one line that all reads share. So a
// network file system whose server has the data in its memory and whose client has nothing cached behaves.
#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

namespace {

using Clock = std::chrono::steady_clock;

struct Line {
    const char* under = std::getenv("PCM_LATENCY_UNDER");
    double latency_s = 0, bytes_per_s = 0;
    std::mutex mutex;
    Clock::time_point free = Clock::now();  // when the line has sent what was asked for so far

    Line()
    {
        if (const char* ms = std::getenv("PCM_LATENCY_MS")) latency_s = std::atof(ms) / 1000;
        if (const char* rate = std::getenv("PCM_LATENCY_MBS")) bytes_per_s = std::atof(rate) * 1e6;
    }
};

void wait_for(int file, ssize_t bytes)
{
    static Line line;
    if (!line.under || bytes <= 0) return;
    char link[64], path[PATH_MAX];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length <= 0) return;
    path[length] = 0;
    if (std::strncmp(path, line.under, std::strlen(line.under)) != 0) return;
    const auto seconds = [](double s) {
        return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
    };
    Clock::time_point until = Clock::now() + seconds(line.latency_s);
    if (line.bytes_per_s > 0) {
        const std::lock_guard lock(line.mutex);
        line.free = std::max(line.free, until) + seconds(static_cast<double>(bytes) / line.bytes_per_s);
        until = line.free;
    }
    std::this_thread::sleep_until(until);
}

template <class Function>
Function next(const char* name)
{
    void* found = dlsym(RTLD_NEXT, name);
    Function function;
    std::memcpy(&function, &found, sizeof function);
    return function;
}

}  // namespace

extern "C" {

ssize_t pread(int file, void* to, size_t bytes, off_t offset)
{
    static const auto real = next<ssize_t (*)(int, void*, size_t, off_t)>("pread");
    const ssize_t got = real(file, to, bytes, offset);
    wait_for(file, got);
    return got;
}
ssize_t pread64(int file, void* to, size_t bytes, off_t offset) { return pread(file, to, bytes, offset); }

ssize_t read(int file, void* to, size_t bytes)
{
    static const auto real = next<ssize_t (*)(int, void*, size_t)>("read");
    const ssize_t got = real(file, to, bytes);
    wait_for(file, got);
    return got;
}

}  // extern "C"
