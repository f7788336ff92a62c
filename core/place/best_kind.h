// Which of several fits explains points best.
#pragma once

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

// The fit that is least probable by chance. Kinds have ranks: the plane; cylinder and sphere, which may be planes of
// wide radius; cone and torus, which may be cylinders. One of a higher rank must be as improbable as the one of lower
// rank would be with half the noise, where that is a plane, else with 1 / 1.2 of it: errors of scanners are alike at
// neighbours, and a shape with more parameters can follow them. Fits that are not determined are considered only where
// none is, and refused ones never. The place in the list; nothing where all are refused.
std::optional<std::size_t> best_of(const std::vector<ShapeFit>& fits, const FitPoints& points, double depth);

// A kind that explains the inliers of `fit` among `points` far better: most of them within six standard deviations of
// `noise`, that of the points' surface, and with less than three tenths of the noise of `fit`, or less than half of
// that and no more than 1.25 times `noise`. A plane is that for what bends by no more than scanners do: with a radius
// of 200 times its noise. Nothing where there is none. Of many points some take part. Throws Error(cancelled).
std::optional<ShapeKind> better_kind(const ShapeFit& fit, const std::vector<Vec3d>& points, double noise,
                                     const ProgressFunction& progress = {});

}  // namespace pcm
