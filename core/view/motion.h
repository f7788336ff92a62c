// Where a moving view will be: what it will need can be loaded before.
#pragma once

#include "pcm/view/camera.h"

#include <optional>

namespace pcm {

// The view so many frames after `now` when it goes on as it came from `before`, one frame earlier: the same rigid
// motion, or the same change of scale, again and again. Nothing when it rests, when the two are not comparable (another
// origin or size of the viewport, another projection), or when a matrix is not affine and invertible.
std::optional<Camera> predict(const Camera& before, const Camera& now, unsigned frames);

}  // namespace pcm
