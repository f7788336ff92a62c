// Random numbers that are the same everywhere: splitmix64 (Steele, Lea, Flood 2014).
#pragma once

#include <cstdint>

namespace pcm {

class SampleNumbers {
public:
    explicit SampleNumbers(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next()
    {
        state_ += 0x9e3779b97f4a7c15u;
        std::uint64_t v = state_;
        v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
        v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
        return v ^ (v >> 31);
    }
    // 0 to below - 1; below is at most 2^32. The bias is at most below / 2^32.
    std::uint32_t below(std::uint64_t below) { return static_cast<std::uint32_t>(((next() >> 32) * below) >> 32); }

private:
    std::uint64_t state_;
};

}  // namespace pcm
