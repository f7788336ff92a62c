// The normal equations of points about a patch.
#pragma once

#include "pcm/cloud/numbers.h"
#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/noise_mixture.h"
#include "pcm/fit/working_points.h"

#include <cstddef>
#include <limits>

namespace pcm {

// Which points count.
struct PatchBand {
    double threshold = infinity;
    double least_cosine = -1;  // minimum cosine of the angle between normals; below 0: not compared
    std::size_t points = std::numeric_limits<std::size_t>::max();  // the first of them
    const double* support = nullptr;                               // a factor of each point's weight; null: 1
    double share = 1;      // share of the points within the threshold that belong to the surface
    double deviation = 0;  // standard deviation of these, if it is about known
};

// Without a mixture all points within the threshold weigh 1; `bins` counts the distances of those used.
PatchSums sums_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points,
                  const PatchBand& band, const NoiseMixture* mixture, DistanceBins* bins = nullptr);

// Sums of squares and products of what blocks of neighbouring points pull at the parameters, row by row with
// most_parameters to a row: the errors where those of neighbours are correlated. False: too few blocks.
bool scatter_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, const PatchBand& band,
                const NoiseMixture& mixture, std::array<double, most_parameters * most_parameters>& scatter);

// What the points within the threshold show of chance and influence.
struct BandFacts {
    double chance = 0;     // share near by chance, estimated from twice to four times the threshold
    double influence = 0;  // influence on the result of the most influential point, in units of the mean
};
// `inverse`: full inverse of the products, row by row.
BandFacts facts_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, double threshold,
                   const double* inverse);

// Sets `within` of those of a block to 0 whose normals are farther from the surface's; returns how many. Nothing where
// the cosine is not above 0, or there are no normals.
double take_away_other_normals(const Shape& shape, const WorkingPoints& points, double least_cosine, std::size_t first,
                               std::size_t count, double* within);

void add_to(PatchSums& sums, const PatchBlock& block, std::size_t i);  // one point, of weight 1
void add_to(PatchSums& sums, const PatchSums& other);
void take_from(PatchSums& sums, const PatchSums& other);  // `other`: sums of fewer points

// The equations in units in which all parameters are lengths. One per parameter: parameter = length * unit.
std::array<double, most_parameters> parameter_units(const ShapeModel& model, double extent);

}  // namespace pcm
