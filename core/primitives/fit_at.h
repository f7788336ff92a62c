// From picked places to a primitive and its points: neighbourhood, fit, growth.
#pragma once

#include "pcm/fit/primitive.h"
#include "pcm/point_cloud.h"
#include "pcm/primitives/grow_shape.h"
#include "pcm/primitives/near_points.h"

#include <optional>
#include <vector>

namespace pcm {

struct FitAtOptions {
    ShapeFitOptions fit;
    double radius = 0;      // of the neighbourhood, source units
    std::size_t count = 0;  // or its number of points; both 0: 500 points
    bool grow = true;       // over the cloud; else only the neighbourhood's inliers belong to it
    double step = 0;        // of growth, source units; 0: a few times the spacing of the points
    Selection limit;        // clip box, conditions: nothing else is looked at
    OutlineOptions outline;
    unsigned threads = 0;
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    ProgressFunction progress;
};

struct FittedPrimitive {
    Primitive primitive;  // check primitive.fit.verdict first
    PointSet points;      // that belong to it; empty when refused
    NearPoints near;      // that were fitted
};

// `places`: where the shape was picked; its neighbourhoods together are fitted. `not_places`: where it does not
// lie: points of these neighbourhoods take no part and are not reached. Throws Error(invalid_argument) without places
// and for options out of range, and what points_near(), fit_shape(), grow_shape() throw; a fit that fails is a verdict.
FittedPrimitive fit_at(const PointCloud& cloud, const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places,
                       const FitAtOptions& options);

}  // namespace pcm
