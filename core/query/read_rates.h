// How long reads took so far, for estimates of how long further ones will take.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

namespace pcm {

// A read takes seconds = latency + decoded bytes * rate. Both come from a line fitted to the earlier reads by least
// squares, older ones with exponentially smaller weight. How far reads run in parallel shows in the time that callers
// waited. Any number of threads.
class ReadRates {
public:
    void add_read(std::uint64_t decoded_bytes, double seconds);
    // A caller waited `waited_seconds` for reads that took `read_seconds` in sum.
    void add_wait(double read_seconds, double waited_seconds);

    // The time that a caller will wait for this number of reads with this sum of bytes. Nothing before the first read.
    std::optional<double> seconds(std::uint64_t reads, double decoded_bytes) const;

private:
    mutable std::mutex mutex_;
    double reads_ = 0, bytes_ = 0, seconds_ = 0, bytes_squared_ = 0, bytes_seconds_ = 0;
    double worked_ = 0, waited_ = 0;
};

}  // namespace pcm
