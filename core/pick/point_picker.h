// The point of a cloud that a user sees at a pixel, exactly: of all points, not of those that a picture had time for.
//
// A picture at full resolution shows each point as a splat whose depth grows from its centre on (gl/draw/splat_pass.h),
// and where several cover a pixel the one that is nearest there. This is the same for one ray, but that splats are
// spheres to it: on a surface seen at a graze it picks a point up to a radius before the one whose disc is seen. For a
// point p, with o the ray's start and u its direction,
//     t = u . (p - o)                                 how far along the ray
//     s = |(p - o) - t u|                             how far beside it
//     R = clamp(size_scale r, tolerance_px pixel(t), largest_px pixel(t))
// the point is hit when s <= R and begin <= t <= end; that hit is picked which has the least depth t + s^2 / (2 R), of
// equal ones the lower node, then the lower index. So where a splat is seen its point is picked, between far points one
// within the tolerance is, and what lies behind a closed surface is not.
//
// r is the point's own radius or, without one, its size, as views draw it (view/point_sizes.h, and where splats are
// fitted the factors of view/point_shapes.h), but at most four times
// the spacing of the level before the point's own: each point of a level has a neighbour nearer than once that spacing.
// Only the rim of a splat that stands all alone is lost by that, and without it all points around the ray would have to
// be read.
//
// All in double, on places on the grid; positions of results are the source's numbers (tree/source_rounding.h).
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/selection.h"
#include "pcm/knn/point_blocks.h"
#include "pcm/pick/pick_ray.h"
#include "pcm/system/progress.h"
#include "pcm/threads/task_pool.h"
#include "pcm/view/point_sizes.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace pcm {

// Radii of splats for sizes of points, as views draw them at first; of paraboloids: gl/draw/splat_pass.h.
inline constexpr double picked_size_scale = 1;

struct PickOptions {
    double tolerance_px = 4;                // how far beside a point one may click
    double largest_px = 100;                // larger splats are hit this near to their centre
    double size_scale = picked_size_scale;  // 0: points are drawn as squares of a few pixels
    bool fitted = true;                     // sizes depend on the points' surroundings (SplatMode::fitted)
    std::vector<Condition> where;           // only points that meet all of these are shown
    std::vector<Clip> clips;                // and that all of these hold
    // Hits that are deeper are not looked for: where another cloud is hit already.
    double most_depth = std::numeric_limits<double>::infinity();
    unsigned reads_in_flight = 8;     // chunks that are read at the same time
    std::function<bool()> cancelled;  // asked between chunks, may be empty; true: Error(cancelled)
};

struct PickHit {
    NodeId node = no_node;
    std::uint32_t index = 0;  // in the node's chunk
    double depth = 0;         // t + s^2 / (2 R), source units
    double along = 0;         // t
    double beside = 0;        // s
    double size = 0;          // r
    Vec3d position{};         // source coordinates
};

struct PickResult {
    std::optional<PickHit> hit;
    Outcome outcome;           // points_in: points looked at
    std::uint64_t chunks = 0;  // that were looked at
    std::uint64_t read = 0;    // of these, from disk
};

// For one cloud; any number of threads. The cache outlives the picker. Memory: 4 bytes per node, 64 MB of boxes around
// points (knn/point_blocks.h), and while it reads the segments of reads_in_flight chunks that are near the ray.
class PointPicker {
public:
    explicit PointPicker(L2Cache& cache);

    // The answer for the chunks that the cache holds with the columns needed; nothing is read. So it is a point that is
    // no nearer than the exact one. Throws Error(invalid_argument) for options that make no sense, and what Selector
    // throws.
    PickResult in_memory(const PickRay& ray, const PickOptions& options = {});

    // The exact answer. Chunks that are not in the cache are read past it, best first, and only their segments near the
    // ray. `known` is a hit of the same ray and options, such as that of in_memory(): less has to be read then. Throws
    // also what reading throws.
    PickResult exact(const PickRay& ray, const PickOptions& options = {}, const std::optional<PickHit>& known = {});

    const PointSizes& sizes() const { return sizes_; }

private:
    L2Cache& cache_;
    const PointSizes sizes_;
    BlockCache blocks_;
    TaskPool pool_;
};

}  // namespace pcm
