// Radii by compute shaders.
#pragma once

#include "pcm/ops/operation.h"

namespace pcm::cli {

// Across the normals of the tree, where it has them. Throws what require_compute_shaders() and compute_radii_on_gpu()
// throw; the tree is then as it was.
ops::Result radii_on_gpu(const ops::GpuRadiiRequest& request, const ProgressFunction& progress);

}  // namespace pcm::cli
