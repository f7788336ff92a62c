#include "pcm/query/read_rates.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr double kept = 0.995;  // weight of the earlier reads after each further one: about the last 200 decide

}  // namespace

void ReadRates::add_read(std::uint64_t decoded_bytes, double seconds)
{
    const auto bytes = static_cast<double>(decoded_bytes);
    const std::lock_guard lock(mutex_);
    for (double* sum : {&reads_, &bytes_, &seconds_, &bytes_squared_, &bytes_seconds_}) *sum *= kept;
    reads_ += 1;
    bytes_ += bytes;
    seconds_ += seconds;
    bytes_squared_ += bytes * bytes;
    bytes_seconds_ += bytes * seconds;
}

void ReadRates::add_wait(double read_seconds, double waited_seconds)
{
    if (!(read_seconds > 0)) return;
    const std::lock_guard lock(mutex_);
    worked_ = worked_ * 0.9 + read_seconds;
    waited_ = waited_ * 0.9 + std::min(waited_seconds, read_seconds);
}

std::optional<double> ReadRates::seconds(std::uint64_t reads, double decoded_bytes) const
{
    const std::lock_guard lock(mutex_);
    if (!(reads_ > 0)) return std::nullopt;
    const double spread = bytes_squared_ - bytes_ * bytes_ / reads_;
    double rate = 0;
    if (spread > 1e-6 * bytes_squared_) rate = (bytes_seconds_ - bytes_ * seconds_ / reads_) / spread;
    double latency = (seconds_ - rate * bytes_) / reads_;
    // Reads of one size, or times too noisy for a line: all of the time is put down to the bytes.
    if (!(rate > 0) || !(latency >= 0)) {
        latency = bytes_ > 0 ? 0 : seconds_ / reads_;
        rate = bytes_ > 0 ? seconds_ / bytes_ : 0;
    }
    const double work = static_cast<double>(reads) * latency + decoded_bytes * rate;
    return worked_ > 0 ? work * waited_ / worked_ : work;
}

}  // namespace pcm
