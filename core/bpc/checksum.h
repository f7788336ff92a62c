// The checksum of everything on disk: XXH3, 64 bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace pcm {

std::uint64_t checksum(const void* data, std::size_t bytes);

// The same for bytes that come piece by piece. One thread at a time.
class RunningChecksum {
public:
    RunningChecksum();
    ~RunningChecksum();
    RunningChecksum(const RunningChecksum&) = delete;
    RunningChecksum& operator=(const RunningChecksum&) = delete;
    void add(const void* data, std::size_t bytes);
    std::uint64_t value() const;  // checksum of all bytes so far

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pcm
