// Progress and cancel, and what every operation reports when it is done.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace pcm {

struct ProgressUpdate {
    std::string_view stage;    // "Reading points", "Building chunks", ... in words a user can read
    double fraction = 0;       // of the whole operation, 0..1, never falling
    double seconds_left = -1;  // estimate; negative while unknown
};

// Called on the thread that runs the operation, a few times a second. Returning false cancels: the operation cleans up
// behind itself and throws Error(cancelled). An empty function means nobody is watching.
using ProgressFunction = std::function<bool(const ProgressUpdate&)>;

// The result line of every operation: what went in, what came out, how long it took, how exact it is.
struct Outcome {
    std::uint64_t points_in = 0;
    std::uint64_t points_out = 0;
    double seconds = 0;
    double error = 0;           // in the unit that `error_meaning` names; 0 when the result is exact
    std::string error_meaning;  // e.g. "largest position error, source units"
};

}  // namespace pcm
