// Whether the points around a place make up a surface that is turned away from a shape: normals, computed where they
// are compared, so that growth does not pass through what a shape only cuts: crowns of trees, the slopes of a heap.
#pragma once

#include "pcm/place/near_shape.h"
#include "pcm/select/surroundings_test.h"
#include "pcm/shapes/shape.h"

#include <memory>

namespace pcm {

// Passes for places in cubes whose points, with those of the cubes around them, lie along the shape. Each block of 27
// cubes gets a plane by total least squares through its points up to half a block from the shape, in two directions
// along the shape and the distance from it, so that it is level on a shape of any curvature. The plane is turned where
// its angle to the shape is larger than `angle` by more than three standard deviations. Blocks of few points or of
// points on one line pass. Does not depend on the order of points except for rounding.
class TurnedSurface final : public SurroundingsTest {
public:
    // threshold: of growth; edge: of a cube, above 0; source units. angle: radians, above 0. Throws
    // Error(invalid_argument) for an edge or angle that is not that, and what NearShape throws.
    TurnedSurface(const Shape& shape, double threshold, double edge, double angle, const TreeInfo& tree);
    // Blocks as wide as the step of growth is long, which is a few times the gaps between points, and wide relative to
    // the noise, one standard deviation.
    static double edge_for(double step, double noise);
    // Whether blocks of these cubes show the surface of a shape: not where it is a pipe so thin that all around it, and
    // its neighbours in a rack, lie in one. A shape that the threshold blurs is not a pipe.
    static bool is_shown_on(const Shape& shape, double threshold, double edge);

    // Memory: 176 bytes per cube with points, of which there are no more than points, and 352 per brick of 64 cubes.
    std::unique_ptr<Judge> judge() const override;
    double margin() const override { return 2 * edge_; }
    const PlaceTest& counts() const override { return near_; }

private:
    const Shape shape_;
    const double edge_, angle_;
    const Vec3d corner_;
    const NearShape near_;
};

}  // namespace pcm
