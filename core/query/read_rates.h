// How long reading took so far, for estimates of how long it will take.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

namespace pcm {

// Reads take seconds = latency + decoded bytes * rate; both come from a line through the reads seen, of which old ones
// count less and less. How many reads ran beside each other shows in the time that callers waited. Any number of
// threads.
class ReadRates {
public:
    void add_read(std::uint64_t decoded_bytes, double seconds);
    // Of a caller that went through `reads` of these: the time that passed in all.
    void add_wait(double read_seconds, double waited_seconds);

    // Nothing before the first read.
    std::optional<double> seconds(std::uint64_t reads, double decoded_bytes) const;

private:
    mutable std::mutex mutex_;
    double reads_ = 0, bytes_ = 0, seconds_ = 0, bytes_squared_ = 0, bytes_seconds_ = 0;
    double worked_ = 0, waited_ = 0;
};

}  // namespace pcm
