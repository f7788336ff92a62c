// Points on one shape among outliers, with exact truth, for bench_fit.
#pragma once

#include "pcm/fit/fit_points.h"
#include "pcm/shapes/shape.h"

#include <cstdint>
#include <vector>

namespace pcm::bench {

struct FitSceneOptions {
    ShapeKind kind = ShapeKind::plane;  // plane, cylinder, sphere, cone
    std::size_t points = 3038;
    double outliers = 0.3;  // share of the points, evenly in the box of the others, a tenth wider
    double sigma = 0.005;   // of the points along the normal, source units
    double radius = 0.5;
    double size = 3;           // side of the plane's square, length of the cylinder and cone
    double arc = 2 * pi;       // of the cylinder and cone about the axis, radians
    double patch = 0;          // diameter of the part of the sphere that has points; 0: all of it
    Vec3d offset{};            // of the whole scene
    bool with_normals = true;  // of all points, estimated
    std::uint64_t seed = 1;
};

struct FitScene {
    FitSceneOptions options;
    Shape truth;
    FitPoints points;                    // in no order
    std::vector<std::uint8_t> on_shape;  // a byte per point
    std::vector<Vec3d> surface;          // exact places on the part of the truth that has points
    Vec3d middle{};                      // of these
};

// The same options give the same scene.
FitScene make_scene(const FitSceneOptions& options);

// How far a shape is from the truth.
struct FitError {
    double surface = 0;   // rms distance of the truth's part from it, source units
    double angle = 0;     // of normal or axis, radians
    double position = 0;  // of the plane along its normal, of an axis across it, both at the middle; of the centre
    double radius = 0;    // source units; of a cone its angle, radians
};
FitError error_of(const FitScene& scene, const Shape& found);

// Least squares of the points that are on the shape, from the truth on, in long double and by code of its own. A method
// that has to find these points first does well if it comes near.
Shape oracle(const FitScene& scene);

}  // namespace pcm::bench
