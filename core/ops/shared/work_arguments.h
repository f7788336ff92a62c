// Memory, threads and the size of chunks.
#pragma once

#include "pcm/filter/filter_report.h"
#include "pcm/ops/argument.h"

#include <cstdint>
#include <string>

namespace pcm::ops {

struct WorkArguments {
    std::uint64_t memory = std::uint64_t(512) << 20;
    std::uint32_t threads = 0;  // 0: one per processor
    // `least`: the smallest limit that the operation keeps to.
    void declare(Arguments& arguments, std::uint64_t least);
    void declare_threads(Arguments& arguments);
    // For an operation that has no least amount; `amount` is the default, `use` what the memory is for.
    void declare(Arguments& arguments, std::uint64_t amount, const std::string& use);
    // Throws Error(invalid_argument) for a limit below the least; otherwise makes the allocator return large blocks, so
    // that the limit is kept.
    void keep_memory_limit(const std::string& called) const;

private:
    std::uint64_t least_ = 0;
};

void chunk_points_argument(Arguments& arguments, std::uint32_t& chunk_points);

// Adds a note where the process took more memory than the limit.
void note_memory(FilterReport& report, std::uint64_t limit);

}  // namespace pcm::ops
