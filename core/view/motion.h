// Predicts a moving camera, so that what it will need can be loaded in advance.
#pragma once

#include "pcm/view/camera.h"

#include <optional>

namespace pcm {

// The camera `frames` frames after `now` if its motion since `before`, one frame earlier, continues: the same rigid
// motion or change of scale repeated. Absent when it rests, when the two are not comparable (different origin, viewport
// or projection), or when a matrix is not affine and invertible.
std::optional<Camera> predict(const Camera& before, const Camera& now, unsigned frames);

}  // namespace pcm
