// Progress reports of a running operation.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/progress.h"

#include <algorithm>
#include <chrono>
#include <string_view>

namespace pcm {

// Passes progress on to the user, at most ten times a second, and turns the wish to cancel into an exception. For the
// thread that runs the operation; the progress function outlives the watch.
class Watch {
public:
    explicit Watch(const ProgressFunction& progress)
        : progress_(progress), start_(std::chrono::steady_clock::now()), last_(start_)
    {
    }

    // Since the construction.
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

    // The fraction that the user sees never decreases. `at_once` reports however little time has passed. Throws
    // Error(cancelled).
    void report(std::string_view stage, double fraction, bool at_once = false)
    {
        if (!progress_) return;
        const auto now = std::chrono::steady_clock::now();
        if (!at_once && fraction < 1 && now - last_ < std::chrono::milliseconds(100)) return;
        last_ = now;
        if (!show(stage, fraction)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }

    // The last report of an operation whose result already stands: it can no longer be cancelled.
    void finish(std::string_view stage)
    {
        if (progress_) show(stage, 1);
    }

private:
    bool show(std::string_view stage, double fraction)
    {
        fraction_ = std::clamp(fraction, fraction_, 1.0);
        ProgressUpdate update;
        update.stage = stage;
        update.fraction = fraction_;
        if (fraction_ > 0.02) update.seconds_left = seconds() * (1 - fraction_) / fraction_;
        return progress_(update);
    }

    const ProgressFunction& progress_;
    std::chrono::steady_clock::time_point start_, last_;
    double fraction_ = 0;
};

}  // namespace pcm
