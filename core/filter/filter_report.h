// What a filter reports in addition to its result.
#pragma once

#include "pcm/system/progress.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// The error of one computed attribute, over a random sample of points.
struct SampledError {
    std::string what;  // "radii", "normals", ...
    std::string unit;  // "%" of the exact value, or "degrees"
    double median = 0, p95 = 0;
    double p95_low = 0, p95_high = 0;  // between them is that of all points, with 95 % probability
};

struct FilterReport {
    Outcome outcome;                      // points in and out, seconds, warnings
    std::uint64_t peak_memory_bytes = 0;  // peak of the process so far
    // The precision: points of finer levels took the values of their nearest point of this level or a coarser one. All
    // points were computed, so that the result is exact, when absent.
    std::optional<std::uint16_t> level;
    std::uint64_t points_checked = 0;  // against the exact answer
    std::vector<SampledError> errors;
    std::vector<std::string> notes;
};

// "radii at level 6: 3.1 s, median error 2.4 %, p95 7.9 % [7.1 to 8.8] (1000 points checked)", or "radii: 3.1 s,
// exact". `what` is the result as a noun.
std::string outcome_text(const std::string& what, const FilterReport& report);

}  // namespace pcm
