// What a filter reports in addition to its result.
#pragma once

#include "pcm/system/progress.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

struct FilterReport {
    Outcome outcome;                      // points in and out, seconds, warnings
    std::uint64_t peak_memory_bytes = 0;  // peak of the process so far
    std::vector<std::string> notes;
};

// "radii: 3.1 s, exact". `what` is the result as a noun.
std::string outcome_text(const std::string& what, const FilterReport& report);

}  // namespace pcm
