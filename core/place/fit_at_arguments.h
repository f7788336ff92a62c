// What fit_at() refuses, and what it makes of its arguments.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/place/fit_at.h"

#include <vector>

namespace pcm {

// Throws Error(invalid_argument) for what fit_at() refuses before it reads anything.
void require_arguments(const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places,
                       const FitAtOptions& options);

// The points around a place off the surface, which are neither fitted nor reached: up to the radius of its own
// neighbourhood, and to half the way to the nearest of `places`. Throws what points_near() throws.
Clip left_out(const PointCloud& cloud, const Vec3d& place, const std::vector<Vec3d>& places, const Selection& limit,
              const FitAtOptions& options);

// FitAtOptions::registration in source units.
double registration_of(const FitAtOptions& options, const Tree& tree);

}  // namespace pcm
