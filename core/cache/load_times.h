// How long the loads of a cache took, as a distribution in constant memory.
#pragma once

#include <array>
#include <cstdint>

namespace pcm {

// Bucket b counts the times of [2^b, 2^(b+1)) microseconds; the first one all shorter ones too, the last one (from 8.4
// s) all longer ones. A value: no member is safe beside add() on another thread.
struct LoadTimes {
    std::array<std::uint64_t, 24> buckets{};

    void add(double seconds);
    std::uint64_t count() const;
    // Seconds within which the share q (0 to 1) of all loads were done; 0 when there were none. Right to a bucket, that
    // is to a factor of two: inside of a bucket the times are taken to lie evenly.
    double quantile(double q) const;
    LoadTimes& operator+=(const LoadTimes& other);
    bool operator==(const LoadTimes& other) const { return buckets == other.buckets; }
};

}  // namespace pcm
