// Elbows of detected pipes: a detection looks for cylinders, and a bend between two of them, or behind one, is a torus
// whose place they state.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/point_cloud.h"
#include "pcm/shapes/primitive.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <vector>

namespace pcm {

struct ElbowOptions {
    Selection limit;          // nothing else is looked at
    double registration = 0;  // FitAtOptions::registration, millimetres
    unsigned threads = 0;     // 0: one per processor
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    ProgressFunction progress;
};

struct ElbowReport {
    std::vector<Primitive> elbows;
    std::vector<double> agreement;  // one for each elbow, as FittedPrimitive::agreement
    std::vector<bool> is_piece;     // keyed by place in the list: whether it is a piece of one of them (elbow_pieces.h)
};

// Elbows that continue cylinders of the list as a pipe run (piping/pipe_run.h): tori fitted to the cloud's points
// (place/fit_at.h), named "Elbow 1" and so on, without labels. First those where the axes of two pipes of one radius
// meet: the bend's radius with which most points lie on an arc that touches both axes states where that fit begins.
// Each end of a pipe has one at most, the pairs nearest to where their axes meet are tried first, and cylinders that
// may be pieces of elbows (elbow_pieces.h) after the others: where they are, the elbow has no pipe there. Then those
// behind the other ends, where the points bend away (place/near_bend.h): the pipe behind them may have too few points.
// The length of a pipe whose points reach into an accepted elbow is cut where the arc begins. Elbows are good, or
// between two pipes of too few points to be (FitIssue::thin_arc). Bends between two pipes of less than
// piping.corners.min_turn and of more than max_turn are not looked for. Throws what fit_at() throws for limits,
// Error(cancelled), and what reading throws.
ElbowReport find_elbows(const PointCloud& cloud, std::vector<Primitive>& primitives, const ElbowOptions& options);

}  // namespace pcm
