// The points in a lasso that are seen from the camera, without those that others hide.
#pragma once

#include "pcm/cloud/polygon.h"
#include "pcm/cloud/selection.h"
#include "pcm/query/point_set.h"
#include "pcm/select/select_points.h"
#include "pcm/view/camera.h"

#include <memory>
#include <vector>

namespace pcm {

struct FrontOptions {
    Selection shown;         // only points that it chooses are seen, and hide others
    double tolerance = 2;    // in sizes of a point: how far behind the nearest surface it still belongs to it
    SelectOptions select{};  // its level has no effect on what hides: both are taken of that level
};

// `polygon` in normalised device coordinates, as of Region::lasso(). A point of the lasso counts when it is drawn
// within the viewport and lies no deeper than
//
//     (depth of its pixel) + tolerance * (its size)
//
// where depths are lengths along the view. A point's size is that of tree/point_size.h, and at least half a pixel at
// its depth. The depth of a pixel is the minimum of d + s * (r / R)^2 over the shown points (paraboloids, as at rest on
// the screen, so that surfaces seen at an angle do not hide themselves): d the depth and s the size of a point, R its
// size on the screen, at most 64 pixels, and r <= R the distance of the pixel's centre from it; for the pixel
// that holds the point itself it is d. So a surface hides what is behind it where its points are dense enough to close
// it.
//
// The result depends on the tree, the camera and the options alone. Two passes over the points in the lasso's rectangle
// on the screen and 64 pixels around it; memory: 8 bytes per pixel of the rectangle, the set, and a chunk per thread.
// Throws Error(invalid_argument) for a viewport that is not 1 to 16384 pixels wide and high and a tolerance that is
// negative or not finite; what Region::lasso() and select_points() throw.
PointSet front_points(const std::shared_ptr<const Tree>& tree, const Camera& camera, const std::vector<Vec2d>& polygon,
                      const FrontOptions& options = {});

}  // namespace pcm
