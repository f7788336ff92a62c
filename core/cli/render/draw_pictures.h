// Draws trees to pictures without a window.
#pragma once

#include "pcm/ops/render_request.h"
#include "pcm/ops/result.h"
#include "pcm/system/progress.h"

namespace pcm::cli {

// Throws Error: invalid_argument for a request that makes no sense, exists for a picture that would be replaced without
// `overwrite`, cancelled, and what opening the trees, drawing and writing throw.
ops::Result draw_pictures(const ops::RenderRequest& request, const ProgressFunction& progress);

}  // namespace pcm::cli
