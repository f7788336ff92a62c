// The distribution of a cache's load times, in constant memory.
#pragma once

#include <array>
#include <cstdint>

namespace pcm {

// Bucket b counts the times in [2^b, 2^(b+1)) microseconds; the first bucket also counts shorter times, the last one
// (from 8.4 s) longer ones. A value type: no member may be called while another thread calls add().
struct LoadTimes {
    std::array<std::uint64_t, 24> buckets{};

    void add(double seconds);
    std::uint64_t count() const;
    // The q-quantile (q from 0 to 1) of the load times, in seconds; 0 without loads. Accurate to a bucket, that is to a
    // factor of two: the times in a bucket are taken as evenly distributed.
    double quantile(double q) const;
    LoadTimes& operator+=(const LoadTimes& other);
    bool operator==(const LoadTimes& other) const { return buckets == other.buckets; }
};

}  // namespace pcm
