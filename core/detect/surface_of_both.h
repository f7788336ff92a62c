// Whether two parts lie on one surface, and on which.
#pragma once

#include "pcm/detect/part_joining.h"
#include "pcm/shapes/shape.h"

#include <optional>
#include <vector>

namespace pcm {

struct PartSurface {
    const Shape& shape;                // source coordinates
    double threshold = 0;              // source units
    const std::vector<Vec3d>& points;  // source coordinates; 20 and more
    bool is_small = false;             // fewer points than a primitive's minimum
};

bool can_be_joined(ShapeKind kind);
// Distance from a part within which others may be on one surface with it; `extent`: size of the part, source units.
double most_gap(ShapeKind kind, double extent, const PartJoinOptions& options);

// The surface of two parts of one kind, that of the first one refined: it is fitted to half of the points, and the
// other half lies on it. Null where the parts are not on one, or too far apart. Planes: their hulls are near, and have
// most of the hull of both together. Cylinders: one of them is small, they have most of the length of both together,
// and radii that differ by no more than their errors. Other kinds: null.
std::optional<Shape> surface_of_both(const PartSurface& one, const PartSurface& other, const PartJoinOptions& options);

}  // namespace pcm
