// What this process has done so far, counted where it is done. Any thread. Two readings around a piece of work show
// what it took; what other threads of the process do meanwhile counts too.
#pragma once

#include <cstdint>

namespace pcm {

struct WorkDone {
    double cpu_seconds = 0;            // processor time of all threads, in the program and in the system
    std::uint64_t points_read = 0;     // decoded, of trees' chunks and of files; again for each time
    std::uint64_t bytes_read = 0;      // asked of files, temporary ones among them; the system may have them in memory
    std::uint64_t reads = 0;           // in which they were asked for
    std::uint64_t requests = 0;        // to servers, those included that failed
    std::uint64_t bytes_received = 0;  // from them
};
WorkDone work_done();
WorkDone operator-(const WorkDone& after, const WorkDone& before);

void count_points_read(std::uint64_t points);
void count_read(std::uint64_t bytes);
void count_request(std::uint64_t bytes);  // a request to a server, and what it brought

}  // namespace pcm
