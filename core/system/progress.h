// Progress and cancellation, and the result that every operation reports.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

struct ProgressUpdate {
    std::string_view stage;    // for users: "Reading points", "Building chunks", ...
    double fraction = 0;       // fraction of the whole operation, 0..1, never decreasing
    double seconds_left = -1;  // estimate; negative while unknown
};

// Called on the thread that runs the operation, a few times a second. Returning false cancels: the operation cleans up
// and throws Error(cancelled). May be empty.
using ProgressFunction = std::function<bool(const ProgressUpdate&)>;

// The result of every operation: points in and out, time, accuracy.
struct Outcome {
    std::uint64_t points_in = 0;
    std::uint64_t points_out = 0;
    double seconds = 0;
    double error = 0;           // error of the kind and unit that `error_meaning` names; 0 when the result is exact
    std::string error_meaning;  // e.g. "largest position error, source units"
    // The result is in place, but a later step failed: it may not survive a loss of power, or remains could not be
    // removed. Repeating the operation would do it twice.
    std::vector<std::string> warnings;
};

// Runs `step`, the last one, which puts the result in place. A failure after that becomes a warning of `outcome`; what
// leaves the result out of place is thrown.
void run_last_step(Outcome& outcome, const std::function<void()>& step);

}  // namespace pcm
