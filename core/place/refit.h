// Least squares of a shape to a set of points that need not fit in memory.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

namespace pcm {

struct RefitOptions {
    double threshold = 0;      // maximum distance of the points, source units; for the result's verdict
    unsigned most_steps = 10;  // 0: keeps the shape, and computes its errors
    unsigned threads = 0;      // 0: one per processor
    ProgressFunction progress;
};

struct RefittedShape {
    ShapeFit fit;  // without is_inlier; its errors include `agreement`
    Box3d box;     // around the points, source coordinates
    // How many times as large the errors are as those of independent points, at least 1: the root of
    //
    //     (sum over cells of (sum of the distances in the cell)^2) / (sum of all squared distances)
    //
    // over cubes a sixteenth as wide as the box's diagonal, where that is above 1 by more than three of its own
    // standard deviations. Neighbours share errors of scanners, and those of a shape that is not quite the true one.
    double agreement = 1;
};

// Uses all points of the set. Streams from the tree on disk, once per step and once more; memory: a chunk per
// thread and less than a kilobyte per node of the set. The sums of nodes are added in the nodes' order, so the result
// depends neither on threads nor on memory. A set without points, or with too few, gives a refusal. Throws what check()
// throws, Error(cancelled), and what reading throws.
RefittedShape refit_shape(const PointSet& points, const Shape& start, const RefitOptions& options);

// How far two shapes of one kind are apart near a place, by their numbers: planes along the normal, axes across them.
ShapeErrors difference_of(const Shape& from, const Shape& to, const Vec3d& middle);

// Whether the errors leave each of the sizes as certain as a good fit's (fit.judgement.good_significance). True for
// planes.
bool is_size_certain(const ShapeFit& fit);

// What points at the edges of a shape, where other surfaces meet it, have moved its fit by, beyond what chance moves
// the fit of the inner points alone: becomes a part of the fit's errors. Doubts a good fit whose size is then
// uncertain, and one whose inner points determine no shape. `middle`: near the points.
void contain_edges(const ShapeFit& inner, const Vec3d& middle, ShapeFit& fit);

// Takes a shape that corrects the fit's. `uncertain`: share of the way to it that becomes a part of the errors.
void correct(const Shape& corrected, double uncertain, const Vec3d& middle, ShapeFit& fit);

// How far two shapes of one kind are apart near a place, in units of the errors: the largest quotient of a change and
// its error. 0 where all errors are infinite; infinite for a change where the error is 0.
double change_in_errors(const Shape& from, const Shape& to, const ShapeErrors& errors, const Vec3d& middle);

}  // namespace pcm
