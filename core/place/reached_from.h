// How the points of a fitted shape were reached: a few numbers, from which the same points are reached again.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/query/point_set.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

struct ReachedFrom {
    Shape shape;              // shape that the points are near
    double threshold = 0;     // maximum distance from it, source units
    double normal_angle = 4;  // as in ShapeFitOptions
    double turned_angle = 4;  // as in GrowShapeOptions, as is the next one
    double turned_edge = 0;
    double step = 0;           // step of growth, source units; 0: only the points at the seeds
    std::vector<Vec3d> seeds;  // places of points, source coordinates
    Selection limit;           // nothing else was looked at
};

// Keeps the seeds (places of points) from which growth reaches the same points as from all of them: one of each group
// that steps connect, near the shape. Keeps all seeds where there was no growth, and where normals or surfaces are
// compared, which may exclude a seed, unless all are known to be reached.
void keep_few_seeds(ReachedFrom& from, bool are_reached = false);

struct ReachOptions {
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    unsigned threads = 0;  // 0: one per processor
    ProgressFunction progress;
};

// The points of the tree that are reached in this way: those that were found, if the tree is as it was. None where no
// point lies at a seed. Exact; streams, memory as select/grow.h. Throws what grow(), NearShape and Selector throw.
PointSet reach_again(const std::shared_ptr<const Tree>& tree, const ReachedFrom& from,
                     const ReachOptions& options = {});

}  // namespace pcm
