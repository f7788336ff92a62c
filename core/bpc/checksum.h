// The checksum of everything on disk: XXH3, 64 bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

struct XXH3_state_s;

namespace pcm {

std::uint64_t checksum(const void* data, std::size_t bytes);

// The same of bytes that come piece by piece. Throws std::bad_alloc.
class RunningChecksum {
public:
    RunningChecksum();
    void add(const void* data, std::size_t bytes);
    std::uint64_t value() const;  // of all pieces so far

private:
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
};

}  // namespace pcm
