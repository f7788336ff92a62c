// The numbers of estimation that no theory gives: each was chosen on scenes, and "Chosen" says on which. A benchmark
// draws the curve of a value again by its name (bench_fit --sweep fit.consensus.max_chance; bench/README.md).
// Sizes of blocks, numbers of rounds and of samples stand where they are used.
#pragma once

#include <cstddef>

namespace pcm {

// Which distances are those of a surface's own noise.
struct ThresholdTuning {
    // Maximum distance of an inlier. Everywhere that a threshold is taken from noise, or noise from a threshold.
    // Chosen: three standard deviations hold 99.7 % of Gaussian noise; not swept.
    double inlier_noises = 3;  // standard deviations
    // Farther residuals from the surface around a place are not its noise. It cuts what measures the noise, and not
    // what belongs to a shape, so it need not be inlier_noises.
    // Chosen: not swept.
    double residual_cut = 3;  // standard deviations
    // Maximum noise of a neighbourhood that shows it: more means that the neighbourhood is as thick as wide.
    // Chosen: not swept.
    double max_local_noise = 0.12;  // share of the neighbourhood's width
    // Threshold for points that show no noise.
    // Chosen: not swept.
    double unknown_noise = 0.01;  // share of the points' extent
    // Least squares looks up to here where the threshold is within the noise, but not farther than max_polish_widening.
    // Chosen: not swept.
    double polish_noises = 4.5;  // standard deviations
    // Chosen: with polish_noises; not swept.
    double max_polish_widening = 2;  // thresholds
};

// Whether points are near a shape by chance.
struct ConsensusTuning {
    // Maximum expected share of chance points near a shape, estimated from the points next to it: 0.5 and more where
    // there is not a surface, and 0.3 for a sphere among six times as many outliers. For fits to points in memory, and
    // at a place of a cloud.
    // Chosen: not swept.
    double max_chance = 0.42;  // share of the points within the threshold
    // Below these, chance points need not be separated from the surface's own.
    // Chosen: not swept.
    double harmless_chance = 0.06;  // share of the points within the threshold
    // Chosen: with harmless_chance; not swept.
    double harmless_influence = 8;  // largest weight of a point, relative to the mean
    // Maximum noise of a nearly flat shape, above which the threshold cuts the noise. Less strict than
    // place.neighbourhood.max_noise_share, which decides whether to look farther, not whether a result is doubtful.
    // Chosen: not swept.
    double max_flat_noise = 0.55;  // thresholds
    // Maximum share of chance points of a nearly flat shape.
    // Chosen: not swept.
    double max_flat_chance = 0.15;  // share of the points within the threshold
};

// The search for a threshold by halving it. All of these were chosen together.
struct HalvingTuning {
    // Narrower bands are of no use: it ends there.
    // Chosen: first 40 scenes of the tables of automatic thresholds (bench/results/fitting/findings.md); not swept.
    double narrow_share = 0.04;  // share of the points' box within the threshold
    // A surface in a wider band shows only a part of itself.
    // Chosen: as narrow_share; not swept.
    double wide_share = 0.1;  // share of the box
    // In a wider band nothing is certain.
    // Chosen: as narrow_share; not swept.
    double max_share = 0.25;  // share of the box
    // A threshold within the noise has slightly fewer false alarms than three standard deviations.
    // Chosen: as narrow_share; not swept.
    double min_improvement = 1.25;  // factor on the logarithm of the number of false alarms
    // Fewer false alarms, and halving ends at the first threshold that is worse.
    // Chosen: as narrow_share; not swept.
    double clear_log_false_alarms = -10;  // natural logarithm
    // More false alarms make a shape with an axis doubtful whose distances are even: it may lie across the points.
    // Chosen: as narrow_share; not swept.
    double log_false_alarm_limit = -25;  // natural logarithm
    // Hardly a point would be within the threshold without the surface.
    // Chosen: as narrow_share; not swept.
    double few_by_chance = 0.2;  // maximum share of the inliers
    // Distances are about even within the threshold where the noise is larger.
    // Chosen: even distances have 0.58; not swept.
    double even_noise = 0.6;  // thresholds
    // Width of the band that is tried next: the band with the minimum number of false alarms is about one and a half
    // standard deviations wide.
    // Chosen: 3 / 1.5; not swept.
    double dense_bands = 2;  // bands of the minimum number of false alarms
    // A larger part of the threshold is not worth another fit.
    // Chosen: not swept.
    double settled_share = 0.7;  // share of the threshold
};

// Whether the points determine the size of a shape.
struct JudgementTuning {
    // Minimum curvature, below which the points are a plane within their noise.
    // Chosen: not swept.
    double min_significance = 5;  // standard deviations of the curvature
    // Minimum curvature of a size that is not doubtful.
    // Chosen: not swept.
    double good_significance = 10;  // standard deviations of the curvature
    // Minimum distance of the points from a plane: errors that many points share bend a plane as much.
    // Chosen: not swept.
    double min_bend = 0.25;  // standard deviations of the noise
    // Errors that neighbours share may differ from those of independent points by this factor by chance alone.
    // Chosen: not swept.
    double error_factor = 1.25;  // factor
    // Below this curvature a shape is nearly flat, and the errors of neighbours are looked at.
    // Chosen: not swept.
    double flat_curvature = 6;  // standard deviations of the noise
};

// When noise and chance points are separated by their distances.
struct MixtureTuning {
    // Minimum number of points that show the mixture.
    // Chosen: not swept.
    std::size_t min_points = 60;  // points
    // A threshold of fewer deviations does not separate noise from others.
    // Chosen: not swept.
    double min_reach = 1.7;  // standard deviations per threshold
    // Where the surface's points are a larger share, all points belong to it.
    // Chosen: not swept.
    double max_share = 0.999;  // share of the points within the threshold
};

// The number of false alarms of a shape in points that lie anywhere.
struct ChanceTestTuning {
    // Shapes differ where a parameter differs by about the threshold: (1 / share)^(tests_per_parameter * parameters).
    // Chosen: with the numbers of HalvingTuning; not swept.
    double tests_per_parameter = 0.8;  // exponent
    // A larger share counts as this one.
    // Chosen: not swept.
    double max_share = 0.1;  // share of the points' box
    // Thickness of the box of a flat cloud.
    // Chosen: not swept.
    double min_side = 0.1;  // share of the largest side
};

// Which points have others of the surface around them.
struct SupportTuning {
    // Fewer inliers are all taken.
    // Chosen: not swept.
    std::size_t min_inliers = 50;  // points
    // Points of the surface in a block of 27 cells, at least.
    // Chosen: not swept.
    double min_block_points = 24;  // points
    // Blocks of many points.
    // Chosen: not swept.
    double blocks = 400;  // blocks
    // More points than chance explains by this many deviations support a point.
    // Chosen: not swept.
    double min_support = 2;  // standard deviations of the number of chance points
};

// How samples are drawn and given up.
struct SamplingTuning {
    // A sample leads to the surface if its normals are within this angle of the surface's.
    // Chosen: not swept.
    double sound_normal = 0.15;  // radians
    // Shapes of inexact normals are near the surface up to this distance.
    // Chosen: not swept.
    double rough_normals = 3;  // thresholds
    // A sample is given up where the first points score worse by more than chance.
    // Chosen: not swept.
    double score_deviations = 2;  // roots of the number of points
    // Samples after which all points are drawn as often as without an order (PROSAC).
    // Chosen: T_N of the paper is 200,000; not swept.
    double even_samples = 20000;  // samples
    // Minimum number of ordered points whose share of inliers is meaningful.
    // Chosen: not swept.
    std::size_t min_share_points = 50;  // points
};

// What errors along a scanner's rays do to a curved shape (ray_errors.h).
struct RayErrorTuning {
    // Minimum length of the mean normal of a station's points, which is the direction of its rays.
    // Chosen: half a cylinder has 0.64 and more; not swept.
    double min_mean_normal = 0.25;  // unit vectors
    // Minimum variance of a surface that rays graze: their beam is wide.
    // Chosen: rays at 80 degrees from the normal have 0.03; not swept.
    double min_along = 0.03;  // variance of the errors along the rays
    // What is left of the bias: directions of rays and the light across a beam are known about.
    // Chosen: pipes of 20 to 600 mm of a ray-cast plant, beam 4 mm wide; not swept.
    double left = 0.4;  // share of the bias
    // Cosine of the angle at which a beam hits the surface, below which its light leaves the shape.
    // Chosen: with widest_beam; not swept.
    double min_beam_cosine = 0.4;  // cosine
    // Width of a beam of which nothing is known: those of scanners are 4 to 8 mm wide at 10 m, two to four deviations.
    // Chosen: by data sheets; the pipes of left show 1.8 mm.
    double widest_beam = 0.002;  // metres, standard deviation
    // Evidence that errors lie along the rays.
    // Chosen: half the square of three standard deviations.
    double min_evidence = 4.5;  // logarithm of the likelihood ratio
};

struct FitTuning {
    ThresholdTuning thresholds;
    ConsensusTuning consensus;
    HalvingTuning halving;
    JudgementTuning judgement;
    MixtureTuning mixture;
    ChanceTestTuning chance_test;
    SupportTuning support;
    SamplingTuning sampling;
    RayErrorTuning ray_errors;
};

// The values above, unless a benchmark has set one (tuned_values.h). Constant while anything works. A loop over points
// reads a value before it begins.
const FitTuning& fit_tuning();

}  // namespace pcm
