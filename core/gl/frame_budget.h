// How many points a frame may have so that it takes no longer than it should.
//
// Model: time = overhead + vertices * time a vertex + pixels * time a pixel, where the pixels are those of splats that are larger than
// their own size. What a frame took is put down to either in the proportion of their shares; what vertices there are beyond one a point
// is expected to stay. How much longer than expected about one frame in a hundred takes is learnt too, and left as a margin, so that the
// slow frames keep to the time asked for as well. Growth is limited and small changes are not followed (hysteresis), so that the density
// does not tremble. Larger splats count for a part of the time at most: more points make them smaller.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pcm {

// What a frame draws.
struct FrameWork {
    std::uint64_t points = 0;
    std::uint64_t vertices = 0;  // runs of the vertex stage, one a point or more
    double pixels = 0;           // of splats larger than their own size, about
};

class FrameBudget {
public:
    static constexpr std::uint64_t first_guess = 1'000'000;
    static constexpr std::uint64_t least =
        20'000;  // a view of fewer points says nothing; most devices draw it at once
    static constexpr double most_growth = 1.5;  // of the points, from one frame to the next
    static constexpr double first_margin = 1.25, largest_margin = 2;  // factors
    static constexpr double share_of_pixels = 0.4;                    // of the time that is aimed at
    // Before anything is known: what a pixel costs in vertices.
    static constexpr double vertices_of_pixel = 0.2;

    // A frame drew so much in so many milliseconds.
    void measured(const FrameWork& work, double milliseconds)
    {
        last_ms_ = milliseconds;
        expected_ms_ = 0;
        // A nearly empty frame measures the fixed cost, not that of a point.
        if (work.points < least / 4) return;
        const auto vertices = static_cast<double>(std::max(work.vertices, work.points));
        if (measures_++ == 0) {
            ms_per_vertex_ = milliseconds / (vertices + vertices_of_pixel * work.pixels);
            ms_per_pixel_ = vertices_of_pixel * ms_per_vertex_;
        } else {
            const double of_vertices = vertices * ms_per_vertex_, of_pixels = work.pixels * ms_per_pixel_;
            expected_ms_ = of_vertices + of_pixels;
            const double error = milliseconds - expected_ms_;
            const double step = 0.25 * error / std::max(of_vertices * of_vertices + of_pixels * of_pixels, 1e-12);
            ms_per_vertex_ *= std::max(0.25, 1 + step * of_vertices);
            ms_per_pixel_ *= std::max(0.25, 1 + step * of_pixels);
        }
        last_pixels_ = work.pixels;
        more_vertices_ = vertices - static_cast<double>(work.points);
    }

    // What else the frame took: choice of nodes, uploads, the picture's way into the host's.
    void measured_overhead(double milliseconds)
    {
        if (measures_ > 3 && expected_ms_ > 0) {
            // A quantile by steps: those up are so much larger than those down that they balance when one frame in 150 is above.
            const double ratio = (last_ms_ + milliseconds) / (expected_ms_ + overhead_ms_);
            margin_ = std::clamp(margin_ * (ratio > margin_ ? 1.25 : 0.9985), 1.05, largest_margin);
            expected_ms_ = 0;  // once a frame that was measured
        }
        overhead_ms_ += (overhead_ms_ == 0 ? 1.0 : 0.2) * (milliseconds - overhead_ms_);
    }

    // Points for the next frame, between `floor` and `ceiling` (which wins).
    std::uint64_t points(double budget_ms, std::uint64_t floor, std::uint64_t ceiling)
    {
        const double goal = goal_points(budget_ms);
        const auto current = static_cast<double>(points_);
        double next = current;
        if (goal < 0.9 * current)
            next = goal;
        else if (goal > 1.2 * current)
            next = std::min(goal, most_growth * current);
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

    // Points of another kind cost something else.
    void forget() { *this = FrameBudget(); }

private:
    double goal_points(double budget_ms) const
    {
        if (measures_ == 0) return static_cast<double>(points_);
        const double pixels_ms = std::min(last_pixels_ * ms_per_pixel_, share_of_pixels * budget_ms / margin_);
        const double left_ms = budget_ms / margin_ - overhead_ms_ - pixels_ms - more_vertices_ * ms_per_vertex_;
        return std::max(0.0, left_ms) / std::max(ms_per_vertex_, 1e-9);
    }

    std::uint64_t points_ = first_guess;
    double ms_per_vertex_ = 0;
    double ms_per_pixel_ = 0;
    double last_pixels_ = 0, more_vertices_ = 0;  // of the latest frame
    double overhead_ms_ = 0;
    double expected_ms_ = 0;  // of the latest frame's drawing, before it was known
    double margin_ = first_margin;
    double last_ms_ = 0;
    unsigned measures_ = 0;
};

}  // namespace pcm
