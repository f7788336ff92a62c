// The numbers of drawing that no theory gives. They decide time, memory and what a moving view leaves out; the picture
// of a resting view has every point whatever they are, but for the sizes in SplatTuning. "Chosen" says on what each was
// chosen; bench_pictures --sweep draws the curve of a value again by its name (bench/README.md). Sizes that are part of
// a data structure stand where it is (l1/vertex_groups.h, compute/chunk_boxes.h), limits of floats and drivers where
// they are checked.
#pragma once

#include <cstddef>

namespace pcm {

// How many points a frame may draw (draw/frame_budget.h).
struct BudgetTuning {
    // Points of the first frame, whose cost is not known.
    // Chosen: not swept.
    std::size_t first_points = 300000;  // points
    // Fewer points show nothing; most devices draw these in no time.
    // Chosen: not swept.
    std::size_t min_points = 20000;  // points
    // Points in the view, whatever the time: on a slow machine a late picture shows more than a few squares for a
    // village. With these, splats that fill the gaps are some 10 pixels wide in a view of 1600 x 1000.
    // Chosen: by such views; not swept.
    double min_points_in_view = 20000;  // points
    // A frame with fewer vertices gives only an upper bound of the cost per point: it measures the fixed cost.
    // Chosen: not swept.
    double nearly_empty = 0.25;  // min_points
    // Maximum growth of the number of points from one frame to the next.
    // Chosen: not swept.
    double max_growth = 1.5;  // factor
    // Growth that is worth another density of points: less is not followed, so that the density does not flicker.
    // Chosen: not swept.
    double min_growth = 1.2;  // factor
    // How fast the mean of the overhead follows the latest frame's.
    // Chosen: not swept.
    double overhead_share = 0.2;  // share of the latest frame
    // Time beyond the budget that a resting view may take for a frame: the delay when the view moves again.
    // Chosen: not swept.
    double max_rest_ms = 50;  // milliseconds
    // Frames after a change of the style that include the driver's compilation.
    // Chosen: not swept.
    std::size_t unmeasured_frames = 2;  // frames
};

// What vertices, splats and pixels cost, learnt by a Kalman filter (draw/frame_budget.h).
struct CostTuning {
    // Initial costs, in proportion to each other.
    // Chosen: not swept.
    double vertex = 1;  // relative
    // Chosen: with vertex; not swept.
    double splat = 1;  // relative
    // Chosen: with vertex; not swept.
    double pixel = 0.2;  // relative
    // Standard deviation of the initial costs.
    // Chosen: not swept.
    double first_deviation = 0.7;  // share of the cost
    // Standard deviation of their change from frame to frame.
    // Chosen: not swept.
    double change = 0.03;  // share of the cost
    // Standard deviation of a measured time.
    // Chosen: not swept.
    double noise = 0.1;  // share of the time
    // A frame that took much longer than expected was probably delayed by something else: its time is clamped.
    // Chosen: not swept.
    double max_surprise = 0.5;  // share of the expected time
    // Minimum factor on a cost in one frame, so that it remains positive.
    // Chosen: not swept.
    double min_factor = 0.25;  // factor
};

// The margin for frames that take longer than expected (draw/frame_budget.h).
struct LateFrameTuning {
    // Chosen: not swept.
    double first_margin = 1.25;  // factor on the expected time
    // Chosen: with first_margin; not swept.
    double min_margin = 1.05;  // factor on the expected time
    // Chosen: with first_margin; not swept.
    double max_margin = 2;  // factor on the expected time
    // A quantile by steps: upward steps are larger than downward ones by the factor at which they balance when one
    // frame in 150 exceeds it.
    // Chosen: that share of frames; not swept.
    double up = 1.25;  // factor on the margin
    // Chosen: with up; not swept.
    double down = 0.9985;  // factor on the margin
    // The margin is that of costs which are known: it is learnt after these frames.
    // Chosen: not swept.
    std::size_t first_frames = 3;  // frames
};

// The sizes of splats.
struct SplatTuning {
    // Paraboloids are larger than the squares that they replace, about as large as circles around these, so that they
    // leave no more holes.
    // Chosen: not swept.
    double paraboloid_radius = 1.25;  // radii of the square
    // Splats of this many times the spacing leave few gaps: the points of a level are a maximal Poisson-disk sample, no
    // two nearer than the spacing and no disc of that radius empty.
    // Chosen: not swept.
    double fill = 1.4;  // spacings
    // Gaps wider than this are not filled any further: such a picture shows nothing anyway.
    // Chosen: not swept.
    double max_fill = 32;  // pixels
    // A box with a smaller range of depths is one place, in the estimate of what a chunk costs (draw/splat_sieve.h).
    // Chosen: not swept.
    double one_place = 0.25;  // depths of its centre
    // One with a larger range is looked at group by group.
    // Chosen: not swept.
    double by_groups = 0.7;  // depths of its centre
};

// The mean of frames that a resting view becomes (draw/smoothing.h).
struct SmoothingTuning {
    // Fewer frames would hardly smooth anything.
    // Chosen: not swept.
    std::size_t min_frames = 4;  // frames
    // All frames of a mean draw no more points than this together: some 0.2 seconds of a graphics card, and a minute of
    // a software renderer.
    // Chosen: by those times; not swept.
    std::size_t max_points = 200000000;  // points
};

// Video memory (l1/l1_cache.h), and the share of it that a moving view draws.
struct VideoMemoryTuning {
    // Frames of all owners for which the entries of an owner that draws nothing are kept.
    // Chosen: not swept.
    std::size_t protected_frames = 16;  // frames
    // Maximum share of the available video memory for what a moving view draws; chunks that only a resting view needs
    // stream through the rest.
    // Chosen: not swept.
    double max_share = 0.75;  // share of the pages
    // Chosen: not swept.
    double min_share = 0.05;  // share of the pages
    // The share shrinks after a refusal, as entries may hold more attributes than were counted, and grows again.
    // Chosen: not swept.
    double after_refusal = 0.9;  // factor on the share
    // Chosen: with after_refusal; not swept.
    double after_success = 1.01;  // factor on the share
};

// Chunks on their way into video memory (draw/chunk_feed.h, draw/resting_view.cpp).
struct LoadingTuning {
    // Maximum chunks in flight. More would not arrive sooner, and chunks that wait for their upload are pinned in L2.
    // Chosen: not swept.
    std::size_t window = 32;  // chunks
    // Maximum number of nodes that one frame of a resting view prepares.
    // Chosen: not swept.
    std::size_t rest_window = 64;  // chunks
    // A chunk that could not be loaded is requested again after this time: the network may be back.
    // Chosen: not swept.
    double retry_after = 5;  // seconds
    // A chunk that was evicted before it was uploaded this many times has failed: the cache is too small.
    // Chosen: not swept.
    std::size_t max_lost = 3;  // arrivals
};

// What a sample of the points says about all of them (draw/cloud_facts.h).
struct SampleTuning {
    // Classes with fewer points say nothing about a cloud: one point in this many.
    // Chosen: not swept.
    std::size_t points_per_classified = 100;  // points of the sample
};

// Radii by compute shaders (compute/gpu_radii.h).
struct GpuRadiiTuning {
    // Boxes of chunks that are kept in memory.
    // Chosen: not swept.
    std::size_t box_megabytes = 32;  // 2^20 bytes
    // Maximum pairs of points that a dispatch compares, so that it ends before a driver takes it for hung.
    // Chosen: not swept.
    std::size_t dispatch_pairs = 2048;  // 2^20 pairs
};

struct GlTuning {
    BudgetTuning budget;
    CostTuning cost;
    LateFrameTuning late;
    SplatTuning splats;
    SmoothingTuning smoothing;
    VideoMemoryTuning memory;
    LoadingTuning loading;
    SampleTuning sample;
    GpuRadiiTuning radii;
};

// The values above, unless a benchmark has set one (tuned_values.h). Constant while anything works. A loop over points
// reads a value before it begins.
const GlTuning& gl_tuning();

}  // namespace pcm
