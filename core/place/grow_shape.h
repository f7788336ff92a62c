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
    double threshold = 0;  // maximum distance of a point from the surface, source units; above 0
    // Each round may raise it to 3.3 times the noise of the points reached, and to two and a half times the given value
    // at most: noise differs along a surface.
    bool raise_threshold = false;
    // At last it is lowered to 3.3 times the noise of the points reached where it is far wider, as that of a
    // neighbourhood of several surfaces: then it takes in points of these.
    bool lower_threshold = false;
    double step = 0;           // maximum distance from point to point, source units; above 0
    double normal_angle = 4;   // as in ShapeFitOptions; only where the cloud has normals
    double turned_angle = 4;   // angle of TurnedSurface, radians; pi / 2 or more: surfaces are not compared
    double turned_edge = 0;    // edge of its cubes, source units; above 0 where surfaces are compared
    unsigned most_rounds = 8;  // rounds of growing and refitting to the points reached; 0: keeps the shape
    Selection limit;           // only points that it chooses are reached
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    unsigned threads = 0;  // 0: one per processor
    ProgressFunction progress;
};

// Distance from a shape, in thresholds, up to which points show what lies next to it.
inline constexpr double around_thresholds = 4;

struct GrownShape {
    // Fit to the points reached, without those that belong to another surface: those next to which the cloud leaves the
    // shape (inner_points.h), unless they are more than half, and straight pipes that an elbow leads into
    // (swept_part.h). Without is_inlier; errors as in refit.h; threshold of the last round.
    ShapeFit fit;
    double noise = 0;               // as fit.noise, of a fit to all points reached
    double agreement = 1;           // RefittedShape::agreement
    PointSet points;                // reached: near `fit.shape`, to a quarter of its errors
    Shape followed;                 // shape of the last round of growth, which `points` are near
    double threshold = 0;           // maximum distance of `points` from `followed`
    std::optional<SweptPart> part;  // part of a swept shape, if `fit` is to the points of that part alone
    // Share of the points next to which the cloud does not leave the shape. Where it is below half, `fit` is to all of
    // them, and its errors contain how far a fit to the inner ones is from it.
    double inner_share = 1;
    PointSet around;         // next to `points`, up to around_thresholds from `fit.shape`; empty without rounds
    unsigned rounds = 0;     // number of rounds done
    bool converged = false;  // the last round changed the shape by less than a quarter of its errors
    double farther = 0;      // how much more than `threshold` points are from `fit.shape` at most
};

// From the seeds (those near the surface), by steps from point to point, through points whose distance from the surface
// is at most the threshold. Streams; memory as select/grow.h. Throws what grow() throws.
GrownShape grow_shape(const Shape& shape, const PointSet& seeds, const GrowShapeOptions& options);

// All points of the cloud near the surface, connected or not, inside of the selection.
PointSet points_on_shape(const std::shared_ptr<const Tree>& tree, const Shape& shape, double threshold,
                         double normal_angle, const Selection& limit, unsigned threads = 0,
                         const ProgressFunction& progress = {});

}  // namespace pcm
