// Follows a shape through a whole cloud: the connected points near its surface.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/place/swept_part.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <optional>

namespace pcm {

struct GrowShapeOptions {
    double threshold = 0;  // largest distance of a point from the surface, source units; above 0
    // Each round may raise it to 3.3 times the noise of the points reached, two and a half times what was given at
    // most: noise differs along a surface.
    bool raise_threshold = false;
    double step = 0;           // longest way from point to point, source units; above 0
    double normal_angle = 4;   // as in ShapeFitOptions; only where the cloud has normals
    double turned_angle = 4;   // largest of TurnedSurface, radians; pi / 2 or more: surfaces are not compared
    double turned_edge = 0;    // and the edge of its cubes, source units; above 0 where surfaces are compared
    unsigned most_rounds = 8;  // of growing and fitting again to what was reached; 0: the shape stays
    Selection limit;           // only points that it chooses are reached
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    unsigned threads = 0;  // 0: one per processor
    ProgressFunction progress;
};

// Points up to so many thresholds from a shape are looked at for what lies beside it.
inline constexpr double beyond_thresholds = 4;

struct GrownShape {
    // To the points reached, but, where these are most of them, without those beside which the cloud leaves the shape
    // (inner_points.h), and without straight pipes that an elbow leads into (swept_part.h): these are another
    // surface's. Without is_inlier; errors as of refit.h, and the threshold of the last round.
    ShapeFit fit;
    double noise = 0;               // as fit.noise, of a fit to all points reached
    double agreement = 1;           // RefittedShape::agreement
    PointSet points;                // reached: near `fit.shape`, to a quarter of its errors
    Shape followed;                 // the shape that they are near, of the last round of growth
    double threshold = 0;           // and within which distance
    std::optional<SweptPart> part;  // of a swept shape, where `fit` is to that part of the points alone
    PointSet around;                // next to these, up to beyond_thresholds from `fit.shape`; empty without rounds
    unsigned rounds = 0;            // done
    bool converged = false;         // the last round changed the shape by less than a quarter of its errors
};

// From the seeds (those near the surface), by steps from point to point, through points whose distance from the surface
// is at most the threshold. Streams; memory as select/grow.h. Throws what grow() throws.
GrownShape grow_shape(const Shape& shape, const PointSet& seeds, const GrowShapeOptions& options);

// All points of the cloud near the surface, connected or not, inside of the selection.
PointSet points_on_shape(const std::shared_ptr<const Tree>& tree, const Shape& shape, double threshold,
                         double normal_angle, const Selection& limit, unsigned threads = 0,
                         const ProgressFunction& progress = {});

}  // namespace pcm
