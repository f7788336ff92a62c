// What frames cost on the device, and how many points they may draw within the frame budget.
//
// Model: time = overhead + vertices * a + splats in view * b + pixels * c. The three counts are estimated before a
// frame is drawn; a, b and c are learnt from measured times by a Kalman filter whose state is a random walk: where
// recent frames do not distinguish the costs, these keep their proportions. The margin by which about one frame in a
// hundred exceeds its expected time is learnt too, so that slow frames also keep to the budget. Growth is limited and
// small changes are not followed (hysteresis), so that the density does not flicker.
#pragma once

#include "pcm/gl/tuning.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace pcm {

// What a frame draws.
struct FrameWork {
    std::uint64_t points = 0;
    std::uint64_t vertices = 0;  // invocations of the vertex stage: none, one or four per point
    double splats = 0;           // points in view, estimated
    double pixels = 0;           // sum over the splats, estimated
    bool at_rest = false;        // a resting view, whose splats cost more
};

class FrameBudget {
public:
    // The drawing of a frame took this long.
    void measured(const FrameWork& work, double milliseconds);
    // The rest of a frame's time, as in a moving view: choice of nodes, uploads, compositing.
    void measured_overhead(double milliseconds);

    // Points to choose for the next frame, between `floor` and `ceiling` (which wins).
    std::uint64_t points(std::uint64_t floor, std::uint64_t ceiling);
    // The expected drawing time that fits into the budget, milliseconds; infinite while nothing has been measured.
    double available(double budget_ms) const;
    // Milliseconds for uploading and drawing what a frame adds to a resting view: all that the budget leaves after
    // the overhead, as no frame is too late; but at least as much as the overhead (up to gl.budget.max_rest_ms), or a
    // small rest would take minutes to draw.
    double at_rest(double budget_ms) const
    {
        return std::max(budget_ms - overhead_ms_, std::min(overhead_ms_, gl_tuning().budget.max_rest_ms));
    }
    double expected(const FrameWork& work) const;
    // There was time only for the first `points` of the points that points() allowed.
    void fewer(std::uint64_t points) { goal_ = static_cast<double>(points); }
    // There would be time for `times` as much as the frame draws.
    void all(const FrameWork& work, double times)
    {
        if (measures_ > 0 && work.points > 0)
            goal_ = std::max(static_cast<double>(points_), times * static_cast<double>(work.points));
    }

    // Whether points() would give more when asked again.
    bool can_grow(std::uint64_t ceiling) const
    {
        return points_ < ceiling && goal_ > gl_tuning().budget.min_growth * static_cast<double>(points_);
    }
    // Whether a frame that draws `work` measures the costs, and none has so far.
    bool is_to_be_measured(const FrameWork& work) const;
    double last_measured_ms() const { return last_ms_; }  // drawing time; 0 before the first

    // Call it when the style changes: costs are learnt anew, the number of points stays.
    void forget()
    {
        const std::uint64_t points = points_;
        *this = FrameBudget();
        goal_ = static_cast<double>(points_ = points);
    }

private:
    using Features = std::array<double, 3>;
    static Features features(const FrameWork& work);

    std::uint64_t points_ = gl_tuning().budget.first_points;
    double goal_ = static_cast<double>(points_);
    Features costs_{};                      // milliseconds: a vertex, a splat, a pixel
    std::array<Features, 3> covariance_{};  // covariance of costs_, relative to themselves
    double overhead_ms_ = 0;
    double expected_ms_ = 0;  // expected time of the latest frame's drawing, before it was known
    double margin_ = gl_tuning().late.first_margin;
    double last_ms_ = 0;
    std::size_t measures_ = 0;
};

}  // namespace pcm
