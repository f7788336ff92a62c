// The command line of radii by compute shaders.
#pragma once

#include "pcm/cli/common.h"

namespace pcm::cli {

Run add_gpu_radii(Options& options);

}  // namespace pcm::cli
