// How many points a frame may have so that it takes no longer than it should.
//
// Model: time = overhead + points * time a point. Both are learnt from measured frames: upwards at once, as a frame that is too slow
// is seen, downwards slowly. Growth is limited to a doubling a frame and small changes are not followed (hysteresis), so that the
// density does not tremble.
#pragma once

#include <algorithm>
#include <cstdint>

namespace pcm {

class FrameBudget {
public:
    static constexpr std::uint64_t first_guess = 1'000'000;
    static constexpr std::uint64_t least =
        20'000;  // a view of fewer points says nothing; most devices draw it at once
    // What is aimed at, of the time asked for: frames differ, and the slow ones should keep to it too.
    static constexpr double aim = 0.8;

    // A frame drew so many points in so many milliseconds.
    void measured(std::uint64_t points, double milliseconds)
    {
        last_ms_ = milliseconds;
        // A nearly empty frame measures the fixed cost, not that of a point.
        if (points < least / 4) return;
        follow(ms_per_point_, milliseconds / static_cast<double>(points));
        ++measures_;
    }
    // What else the frame took: choice of nodes, uploads, the picture's way into the host's.
    void measured_overhead(double milliseconds) { follow(overhead_ms_, milliseconds); }

    // Points for the next frame, between `floor` and `ceiling` (which wins).
    std::uint64_t points(double budget_ms, std::uint64_t floor, std::uint64_t ceiling)
    {
        const double goal = goal_points(budget_ms);
        const auto current = static_cast<double>(points_);
        double next = current;
        if (goal < 0.9 * current)
            next = goal;
        else if (goal > 1.2 * current)
            next = std::min(goal, 2 * current);
        points_ = static_cast<std::uint64_t>(std::clamp(next, static_cast<double>(std::max(floor, least)), 1e12));
        points_ = std::min(points_, std::max(ceiling, std::uint64_t(1)));
        return std::min(points_, ceiling);
    }
    // Whether points() would give more when asked again.
    bool can_grow(double budget_ms, std::uint64_t ceiling) const
    {
        return points_ < ceiling && goal_points(budget_ms) > 1.2 * static_cast<double>(points_);
    }
    double last_measured_ms() const { return last_ms_; }  // of drawing; 0 before the first
    double overhead_ms() const { return overhead_ms_; }
    double ms_per_point() const { return ms_per_point_; }

    // Points of another kind cost something else.
    void forget() { *this = FrameBudget(); }

private:
    static void follow(double& known, double sample) { known += (known == 0 ? 1.0 : sample > known ? 0.5 : 0.15) * (sample - known); }
    double goal_points(double budget_ms) const
    {
        if (measures_ == 0) return static_cast<double>(points_);
        return std::max(0.0, aim * budget_ms - overhead_ms_) / std::max(ms_per_point_, 1e-9);
    }

    std::uint64_t points_ = first_guess;
    double ms_per_point_ = 0;
    double overhead_ms_ = 0;
    double last_ms_ = 0;
    unsigned measures_ = 0;
};

}  // namespace pcm
