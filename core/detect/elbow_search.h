// Elbows between detected pipes: a detection looks for cylinders, and a bend between two of them is a torus whose place
// they state.
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

// Elbows that join two cylinders of the list into a pipe run (piping/pipe_run.h): tori fitted to the cloud's points
// where the axes of two pipes of one radius meet (place/fit_at.h), named "Elbow 1" and so on, without labels. The
// bend's radius with which most points lie on an arc that touches both axes says where that fit begins. Each end of a
// pipe has one at most, the pairs nearest to where their axes meet are tried first. The length of a pipe whose points
// reach into an accepted elbow is cut where the arc begins. Elbows are good, or of too few points to be
// (FitIssue::thin_arc). Bends of less than piping.corners.min_turn and of more than max_turn are not looked for. Throws
// what fit_at() throws for limits, Error(cancelled), and what reading throws.
std::vector<Primitive> find_elbows(const PointCloud& cloud, std::vector<Primitive>& primitives,
                                   const ElbowOptions& options);

}  // namespace pcm
