// What fit_at() refuses.
#pragma once

#include "pcm/place/fit_at.h"

#include <vector>

namespace pcm {

// Throws Error(invalid_argument) for what fit_at() refuses before it reads anything.
void require_arguments(const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places,
                       const FitAtOptions& options);

}  // namespace pcm
