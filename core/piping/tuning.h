// The numbers of joining pipes that no theory gives: "Chosen" says why each is what it is. tests/piping draws random
// pipes and racks with them; `--sweep list` of a benchmark names them (bench/README.md). A radius is the pipe's own.
#pragma once

namespace pcm {

// When two ends are one pipe. Every deviation may be its share and error_sigmas standard deviations, at most its limit.
struct JointTuning {
    // Chosen: 99.7 % of Gaussian errors; not swept.
    double error_sigmas = 3;  // standard deviations
    // Nominal pipe sizes next to each other differ by 8 % and more up to DN 600, and mills are allowed 1 %.
    // Chosen: between the two (ISO 4200, EN 10216-1); not swept.
    double radius_share = 0.025;  // share of the radius
    // Chosen: below half of a step of nominal sizes up to DN 600; not swept.
    double max_radius_share = 0.04;  // share of the radius
    // Axes that miss each other. Pipes of a rack are two radii apart or more.
    // Chosen: fits of real pipes bend and sag by as much; not swept.
    double offset_share = 0.15;  // radii
    // Chosen: a quarter of the distance of two pipes that touch; not swept.
    double max_offset = 0.5;  // radii
    // Chosen: joints of welded pipes are within 1 degree, short pieces are fitted to 2; not swept.
    double angle = 0.05;  // radians
    // Chosen: with angle; not swept.
    double max_angle = 0.14;  // radians
    // Between what points show of two parts: hidden by supports and flanges, or too short for a fit of its own.
    // Chosen: three diameters, a welding-neck flange pair and a gate valve of most sizes; not swept.
    double max_gap = 6;  // radii
    // A cylinder has points of the beginning of an elbow until that leaves its threshold, and the reverse.
    // Chosen: an elbow of three radii leaves a threshold of a third of the radius there; not swept.
    double max_overlap = 1.5;  // radii
    // What the points of an elbow leave open of its arc at one end.
    // Chosen: a third of a quarter turn; not swept.
    double max_open_arc = 0.52;  // radians
};

// Bends that no shape of the list shows: two pipes whose axes meet beyond their ends. A branch of a tee ends one radius
// before the axis of a pipe that reaches there or farther.
struct CornerTuning {
    // Chosen: smaller turns are errors of axes; not swept.
    double min_turn = 0.12;  // radians
    // Chosen: above that the place of the corner is uncertain; not swept.
    double max_turn = 2.2;  // radians
    // Radius of the bend that touches both pipes at the nearer end.
    // Chosen: elbows 1D (EN 10253 type 2) have two radii, less what cylinders overlap; not swept.
    double min_bend = 1.2;  // radii
    // How much farther the other end is from where the axes meet.
    // Chosen: a diameter; not swept.
    double max_difference = 2;  // radii
};

struct PipingTuning {
    JointTuning joints;
    CornerTuning corners;
};

// The values above, unless a benchmark has set one (tuned_values.h). Constant while anything works.
const PipingTuning& piping_tuning();

}  // namespace pcm
