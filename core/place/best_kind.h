// Which of several fits explains points best.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/fit/shape_fit.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

// The logarithm of how many shapes with so many inliers are to be expected among points spread evenly: of `points`, of
// which `inliers` are within a distance that the share `part` of space is near to, when `sample` points make a shape
// (Moisan, Stival 2004). The less, the less probable is the shape by chance.
double log_false_alarms(std::size_t points, std::size_t inliers, std::size_t sample, double part);

// That of a shape among points that fill a depth of `depth` (source units) on both sides of it: for the distance
// min(threshold, 3 noise) of the fit, where that is known.
double chance_of(const ShapeFit& fit, const FitPoints& points, double depth);

// Whether the points determine the shape: the fit is good, or doubtful because least squares did not settle.
bool is_determined(const ShapeFit& fit);

// Shapes are compared by the same points, with the same noise and up to the same distance, whatever thresholds they
// were fitted with: the misfit of a shape is half the sum of min(d, 3 noise)^2 / noise^2, the logarithm of a likelihood
// of Gaussian errors and even outliers without its constant. Of many points a part is used. Keeps references.
class KindComparison {
public:
    // `noise`: one standard deviation, above 0, source units.
    KindComparison(const FitPoints& points, double noise);
    double misfit(const Shape& shape) const;
    // How far the logarithm of the likelihood ratio of a shape to one with fewer parameters is above what is asked for:
    // five standard deviations, and half the logarithm of the number of points for each parameter more (Schwarz 1978).
    // The ratio grows with the number of points; where errors of neighbours are alike it is that of as many points as
    // have errors of their own. And it must be more than a small gain per point, since surfaces of real things are
    // never quite flat. Above 0: the shape is the better one.
    double evidence(const Shape& shape, const Shape& simpler) const;

private:
    double agreement(const Shape& shape) const;

    const FitPoints& points_;
    const double noise_;
    const std::size_t every_;
    Box3d box_;
};

struct KindChoice {
    std::optional<std::size_t> best;  // place in the list; nothing where all are refused
    std::optional<std::size_t> next;  // the best one of another kind
    double log_ratio = 0;             // logarithm of the likelihood of the best one to that of the next
};

// The fit that explains the points best, with the fewest parameters. Kinds have ranks: the plane; cylinder and sphere,
// which may be planes of wide radius; cone and torus, which may be cylinders. One of a higher rank is taken where
// KindComparison has evidence for it, of one rank the one of less misfit; the noise is the least one of the fits that
// have half of the most inliers. Fits that are not determined are considered only where none is, and refused ones
// never.
KindChoice choose_kind(const std::vector<ShapeFit>& fits, const FitPoints& points);

// A kind that explains the inliers of `fit` among `points` far better: most of them within six standard deviations of
// `noise`, that of the points' surface, and with less than three tenths of the noise of `fit`, or less than half of
// that and no more than 1.25 times `noise`. A plane is that for what bends by no more than scanners do: with a radius
// of 200 times its noise. Nothing where there is none. Of many points some take part. Throws Error(cancelled).
std::optional<ShapeKind> better_kind(const ShapeFit& fit, const std::vector<Vec3d>& points, double noise,
                                     const ProgressFunction& progress = {});

}  // namespace pcm
