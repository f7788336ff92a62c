// Damped least squares of the distances of points from a patch.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/working_points.h"

#include <array>
#include <cstdint>
#include <limits>

namespace pcm {

// Which points take part.
struct PatchBand {
    double threshold = std::numeric_limits<double>::infinity();
    double least_cosine = -1;  // of the angle between normals; below 0: not compared
    std::size_t points = std::numeric_limits<std::size_t>::max();  // the first of them
};

PatchSums sums_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points,
                  const PatchBand& band);

// Adds a block's point with a weight; another's sums.
void add_to(PatchSums& sums, const PatchBlock& block, std::size_t i, double weight);
void add_to(PatchSums& sums, const PatchSums& other);

// The step that the sums ask for, each parameter damped by `damping` times its own weight; false: none.
bool step_of(const ShapeModel& model, const PatchSums& sums, double extent, double damping,
             std::array<double, most_parameters>& step);

struct PolishedPatch {
    SurfacePatch patch;
    PatchSums sums;
    bool converged = false;
};

// Gauss-Newton steps, damped where they do not help (Levenberg, Marquardt).
PolishedPatch polish(const ShapeModel& model, const SurfacePatch& start, const WorkingPoints& points,
                     const PatchBand& band, unsigned most_steps);

// Errors, condition, noise, rms, verdict, issue and message of a result in working units; the shape is not set.
ShapeFit judged(const ShapeModel& model, const SurfacePatch& patch, const PatchSums& sums, const Vec3d& middle,
                double extent);
// From working to source units.
void to_source_units(ShapeFit& fit, double unit);

}  // namespace pcm
