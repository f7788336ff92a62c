// Which of several fits explains points best.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/fit/shape_fit.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

inline constexpr std::size_t enough_compared = 3000;  // points by which kinds are compared, of all that are given

// Logarithm of the number of false alarms: the expected number of shapes with `inliers` inliers among `points` points
// spread evenly, when `sample` points determine a shape and the share `part` of space is within the distance of an
// inlier (Moisan, Stival 2004). The smaller it is, the less probable is the shape by chance.
double log_false_alarms(std::size_t points, std::size_t inliers, std::size_t sample, double part);

// log_false_alarms() of a fitted shape among points that fill a depth of `depth` (source units) on both sides of it.
// Inliers are within min(threshold, 3 noise) of the fit, or within its threshold where the noise is unknown.
double chance_of(const ShapeFit& fit, const FitPoints& points, double depth);

// Whether the points determine the shape: the fit is good, or doubtful because least squares did not settle.
bool is_determined(const ShapeFit& fit);

// Compares shapes by the same points, with the same noise and up to the same distance, whatever thresholds they were
// fitted with. The misfit of a shape is half the sum of min(d, 3 noise)^2 / noise^2: the negative logarithm of the
// likelihood of Gaussian errors and even outliers, without its constant. From 3000 points on every second, third, ...
// one is used. Keeps references.
class KindComparison {
public:
    // `noise`: one standard deviation, above 0, source units.
    KindComparison(const FitPoints& points, double noise);
    double misfit(const Shape& shape) const;
    // By how much the logarithm of the likelihood ratio of a shape to one with fewer parameters exceeds its required
    // minimum: that of five standard deviations, plus half the logarithm of the number of points per additional
    // parameter (Schwarz 1978). Where neighbours share errors, the number of points is that of independent points. The
    // ratio must also exceed a small gain per point, since surfaces of real things are never quite flat. Above 0: the
    // shape is the better one.
    double evidence(const Shape& shape, const Shape& simpler) const;

private:
    double agreement(const Shape& shape) const;

    const FitPoints& points_;
    const double noise_;
    const std::size_t every_;
    Box3d box_;
};

// Those within the thresholds of both shapes, by which kinds are compared of which one takes in points of others.
std::vector<Vec3d> points_of_both(const std::vector<Vec3d>& points, const ShapeFit& one, const ShapeFit& other);

// Whether a shape explains its own points, which are `points`, better than one with fewer parameters does: the hole of
// a wide torus is nearly a pipe.
bool explains_better(const ShapeFit& fit, const Shape& simpler, const std::vector<Vec3d>& points);

struct KindChoice {
    std::optional<std::size_t> best;  // place in the list; nothing where all are refused
    std::optional<std::size_t> next;  // the best one of another kind
    double log_ratio = 0;             // logarithm of the likelihood of the best one to that of the next
};

// The fit that explains the points best, with the fewest parameters. Kinds have ranks: the plane; cylinder and sphere,
// which may be planes of wide radius; cone and torus, which may be cylinders. A fit of higher rank is chosen where
// KindComparison has evidence for it; within a rank, the fit of minimum misfit. The noise of the comparison is the
// minimum over the fits that have half of the maximum number of inliers. Fits that are not determined are considered
// only where no fit is; refused fits are not considered.
KindChoice choose_kind(const std::vector<ShapeFit>& fits, const FitPoints& points);

// A kind that explains the inliers of `fit` among `points` far better: it has half of them within six standard
// deviations of `noise`, that of the points' surface, and less than three tenths of the noise of `fit`, or less than
// 0.45 of that and less than 1.25 times `noise`. A plane is not replaced by a shape whose radius is 200 times the
// plane's noise or more: a scanner's errors may bend it as much. Nothing where no kind does. From 3000 inliers on every
// second, third, ... one is used. Throws Error(cancelled).
std::optional<ShapeKind> better_kind(const ShapeFit& fit, const std::vector<Vec3d>& points, double noise,
                                     const ProgressFunction& progress = {});

}  // namespace pcm
