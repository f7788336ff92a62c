// Damped least squares of the distances of points from a patch.
#pragma once

#include "pcm/fit/patch_sums.h"

#include <array>
#include <cstdint>
#include <limits>

namespace pcm {

// The step that the sums ask for, each parameter damped by `damping` times its own weight; false: none.
bool step_of(const ShapeModel& model, const PatchSums& sums, double extent, double damping,
             std::array<double, most_parameters>& step);

struct PolishedPatch {
    SurfacePatch patch;
    PatchSums sums;
    NoiseMixture mixture;
    bool converged = false;
    double noise() const;  // standard deviation of a point of the surface
};

// Whether points that are near by chance matter, and how many they are (facts_of()).
BandFacts band_facts(const ShapeModel& model, const PolishedPatch& polished, const WorkingPoints& points,
                     double threshold);

// Gauss-Newton steps, damped where they do not help (Levenberg, Marquardt), until a step lowers the sum of squares by
// less than `enough` times the mean square: until it is shorter than the root of that in units of the errors. The
// points within the threshold that are likely to belong to the surface count most; the mixture is learned on the
// way.
PolishedPatch polish(const ShapeModel& model, const SurfacePatch& start, const WorkingPoints& points,
                     const PatchBand& band, unsigned most_steps, double enough);
// Improves with equal weights for all points within the threshold.
SurfacePatch improved(const ShapeModel& model, const SurfacePatch& start, const WorkingPoints& points,
                      const PatchBand& band, unsigned most_steps, double enough);

// Errors, condition, verdict, issue and message of a result in working units; the shape is not set. The rms is that of
// weighted distances, and `noise` their deviation.
// With `scatter` (see scatter_of()) errors grow to what it shows.
ShapeFit judged(const ShapeModel& model, const SurfacePatch& patch, const PatchSums& sums, double noise,
                const Vec3d& middle, double extent, const double* scatter = nullptr);
// Errors of the numbers that people read, from the covariance of a patch's parameters: p x p numbers, row by row.
ShapeErrors errors_of_covariance(const ShapeModel& model, const SurfacePatch& patch, const double* covariance,
                                 const Vec3d& middle, double extent);
// Whether the points' noise is not small relative to what they show of the shape's size.
bool is_nearly_flat(const ShapeFit& fit, const Shape& shape, const PatchSums& sums);
// From working to source units.
void to_source_units(ShapeFit& fit, double unit);

}  // namespace pcm
