// What frames cost on the device, and how much they may draw so that they take no longer than they should.
//
// Model: time = overhead + vertices * a + splats in view * b + pixels * c. How much of each a frame has is estimated
// before it is drawn; a, b and c are learnt from the times that frames took, by a Kalman filter whose state is a random
// walk: what recent frames do not tell apart keeps the proportions that are believed. How much longer than expected
// about one frame in a hundred takes is learnt too, and left as a margin, so that the slow frames keep to the time
// asked for as well. Growth is limited and small changes are not followed (hysteresis), so that the density does not
// tremble.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace pcm {

// What a frame draws.
struct FrameWork {
    std::uint64_t points = 0;
    std::uint64_t vertices = 0;  // runs of the vertex stage: none, one or four a point
    double splats = 0;           // of the points, that are in view, about
    double pixels = 0;           // that they cover, each of them, about
};

class FrameBudget {
public:
    static constexpr std::uint64_t first_guess = 300'000;
    static constexpr std::uint64_t least = 20'000;  // a view of fewer points says nothing; most devices draw it at once
    static constexpr double most_growth = 1.5;      // of the points, from one frame to the next
    static constexpr double first_margin = 1.25, largest_margin = 2;  // factors
    static constexpr double most_at_rest =
        50;  // milliseconds beyond the budget: whoever moves the view again has to wait as long

    // A frame drew so much in so many milliseconds.
    void measured(const FrameWork& work, double milliseconds);
    // What else the frame took, of what a moving view's takes: choice of nodes, uploads, the picture's way into the
    // host's.
    void measured_overhead(double milliseconds);

    // Points to choose for the next frame, between `floor` and `ceiling` (which wins).
    std::uint64_t points(std::uint64_t floor, std::uint64_t ceiling);
    // Milliseconds that drawing may be expected to take; infinite as long as nothing is known.
    double available(double budget_ms) const;
    // Milliseconds for what a frame adds to the picture of a view that rests, uploads and drawing: all that the budget
    // has, as no frame is too late; and what each frame takes anyway is matched, up to some point: else where that
    // leaves little it would take minutes.
    double at_rest(double budget_ms) const
    {
        return std::max(budget_ms - overhead_ms_, std::min(overhead_ms_, most_at_rest));
    }
    double expected(const FrameWork& work) const;
    // Of the points that points() allowed there was time for the first so many: all of them, or fewer.
    void fewer(std::uint64_t points) { goal_ = static_cast<double>(points); }
    // For so many times what the frame draws.
    void all(const FrameWork& work, double times)
    {
        if (measures_ > 0 && work.points > 0)
            goal_ = std::max(static_cast<double>(points_), times * static_cast<double>(work.points));
    }

    // Whether points() would give more when asked again.
    bool can_grow(std::uint64_t ceiling) const
    {
        return points_ < ceiling && goal_ > worthwhile * static_cast<double>(points_);
    }
    double last_measured_ms() const { return last_ms_; }  // of drawing; 0 before the first

    // Points of another kind cost something else. It goes on with as many as there were.
    void forget()
    {
        const std::uint64_t points = points_;
        *this = FrameBudget();
        goal_ = static_cast<double>(points_ = points);
    }

private:
    static constexpr double worthwhile = 1.2;  // growth
    using Features = std::array<double, 3>;
    static Features features(const FrameWork& work);

    std::uint64_t points_ = first_guess;
    double goal_ = first_guess;
    Features costs_{};                      // milliseconds: a vertex, a splat, a pixel
    std::array<Features, 3> covariance_{};  // of costs_ in proportion to themselves
    double overhead_ms_ = 0;
    double expected_ms_ = 0;  // of the latest frame's drawing, before it was known
    double margin_ = first_margin;
    double last_ms_ = 0;
    unsigned measures_ = 0;
};

}  // namespace pcm
