// How many points a frame may have so that it takes no longer than it should.
//
// Model: time = points * seconds_per_point, learnt from measured frames. Growth is limited to a doubling a frame and
// small changes are not followed (hysteresis), so that the density does not tremble; too slow a frame is corrected at
// once.
#pragma once

#include <algorithm>
#include <cstdint>

namespace pcm {

class FrameBudget {
public:
    static constexpr std::uint64_t first_guess = 1'000'000;
    static constexpr std::uint64_t least =
        100'000;  // a view of fewer points says nothing; most devices draw it at once

    // Whether the coming frame should be measured: the time of a frame is known when the device has finished it, and to
    // wait for that in every frame would cost the overlap of the processor's work with the device's.
    bool wants_measure() const { return frames_since_measure_ >= (measures_ < 3 ? 0u : 7u); }

    void measured(std::uint64_t points, double milliseconds)
    {
        frames_since_measure_ = 0;
        last_ms_ = milliseconds;
        // A nearly empty frame measures the fixed cost, not that of a point.
        if (points < least / 4) return;
        const double sample = milliseconds / static_cast<double>(points);
        ms_per_point_ = measures_ == 0 ? sample : 0.5 * (ms_per_point_ + sample);
        ++measures_;
    }
    void not_measured() { ++frames_since_measure_; }

    // Points for the next frame, between `floor` and `ceiling` (which wins).
    std::uint64_t points(double budget_ms, std::uint64_t floor, std::uint64_t ceiling)
    {
        const double goal = goal_points(budget_ms);
        const auto current = static_cast<double>(points_);
        double next = current;
        if (goal < 0.85 * current)
            next = goal;
        else if (goal > 1.15 * current)
            next = std::min(goal, 2 * current);
        points_ = static_cast<std::uint64_t>(std::clamp(next, static_cast<double>(std::max(floor, least)), 1e12));
        points_ = std::min(points_, std::max(ceiling, std::uint64_t(1)));
        return std::min(points_, ceiling);
    }
    // Whether points() would give more when asked again.
    bool can_grow(double budget_ms, std::uint64_t ceiling) const
    {
        return points_ < ceiling && goal_points(budget_ms) > 1.15 * static_cast<double>(points_);
    }
    double last_measured_ms() const { return last_ms_; }

private:
    double goal_points(double budget_ms) const
    {
        if (measures_ == 0) return static_cast<double>(points_);
        return budget_ms / std::max(ms_per_point_, 1e-9);
    }

    std::uint64_t points_ = first_guess;
    double ms_per_point_ = 0;
    double last_ms_ = 0;
    unsigned measures_ = 0;
    unsigned frames_since_measure_ = 0;
};

}  // namespace pcm
