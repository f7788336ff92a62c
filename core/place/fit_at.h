// From picked places to a primitive and its points: neighbourhood, fit, growth.
#pragma once

#include "pcm/place/departure.h"
#include "pcm/place/grow_shape.h"
#include "pcm/place/near_points.h"
#include "pcm/place/reached_from.h"
#include "pcm/place/swept_part.h"
#include "pcm/point_cloud.h"
#include "pcm/shapes/primitive.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct FitAtOptions {
    ShapeFitOptions fit;  // when its `seconds` are over, the shape is not followed any farther, too
    // Several kinds: each is fitted, and choose_kind() (best_kind.h) decides. Empty: fit.kind alone.
    std::vector<ShapeKind> kinds;
    double radius = 0;      // neighbourhood of a place, source units
    std::size_t count = 0;  // or its number of points; both 0: chosen, as is the threshold (local_fit.h)
    bool grow = true;       // over the cloud; else only the neighbourhood's inliers belong to it
    // Growth does not pass where the surface of the points is turned from the shape by more than this, radians
    // (turned_surface.h); pi / 2 or more: surfaces are not compared. Computed from the points, whatever normals the
    // cloud has; those are compared where fit.normal_angle asks for it. 0: chosen, pi / 6, or pi / 4 where the noise
    // rises from the place on; not compared where a threshold is given, which states what lies on the surface.
    double turned_angle = 0;
    double step = 0;      // step of growth, source units; 0: from the gaps between the inliers (automatic_step())
    unsigned rounds = 8;  // GrowShapeOptions::most_rounds
    Selection limit;      // clip box, conditions: nothing else is looked at
    // Standard deviation of how far a station of the scanner is shifted along each axis: contained in the errors
    // (station_errors.h). Millimetres; source units are metres where the cloud does not state their unit. 0: unknown.
    double registration = 0;
    OutlineOptions outline;
    unsigned threads = 0;  // 0: one per processor
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    ProgressFunction progress;
    // Is given the shape of the points around the places before it is followed over the cloud, which takes most of the
    // time: with bounds, without what stations add to its errors. Called twice at most: for the nearest points, and
    // for a wider neighbourhood where that is chosen. The answer may be another shape. Not called where no shape is
    // found there, or none is followed. On the calling thread.
    std::function<void(const Primitive&)> found_at_place;
};

struct FittedPrimitive {
    Primitive primitive;  // check primitive.fit.verdict first; without a name
    PointSet points;      // points of the shape; empty when refused
    ReachedFrom reached;  // how they are reached again
    NearPoints near;      // points that were fitted; with several places `radius` is the largest
    ShapeFit local;       // fit to `near`
    double step = 0;      // step of growth, source units; 0: no growth
    unsigned rounds = 0;  // rounds of growth
    bool converged = false;
    double agreement = 1;  // how many times as large errors are as those of independent points (refit.h)
    // Why the points are those around the places alone although the shape was to be followed: growth left the surface,
    // or the time was over.
    // Empty: it did not.
    std::string left_surface;
    std::vector<std::string> notes;  // "the neighbourhood was widened to 2000 points"
    std::optional<SweptPart> part;   // the part of an elbow and its pipes that its shape was fitted to
    // How the points leave the shape together, where that is why it is doubtful (FitIssue::uneven).
    std::optional<Departure> departure;
};

// `places`: where the shape was picked; their neighbourhoods together are fitted. `not_places`: where it does not lie.
// Points in a ball about one of these are neither fitted nor reached; the ball's radius is that of the place's own
// neighbourhood, and at most half the distance to the nearest of `places`. Throws Error(invalid_argument) without
// places and for options out of range, and what points_near(), fit_shape(), grow_shape() throw; a fit that fails is a
// verdict.
FittedPrimitive fit_at(const PointCloud& cloud, const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places,
                       const FitAtOptions& options);

// The step with which growth passes the gaps that scans leave between inliers: four times the minimum distance that
// connects nine tenths of the points. 0 for fewer than two places.
double automatic_step(const std::vector<Vec3d>& inliers);

}  // namespace pcm
