// The models: a row for each kind of shapes/shape_kinds.h.
#pragma once

#include "pcm/fit/models/shape_model.h"

namespace pcm {

#define PCM_SHAPE_MODEL(name) const ShapeModel& name##_model();
PCM_SHAPE_KINDS(PCM_SHAPE_MODEL)
#undef PCM_SHAPE_MODEL

}  // namespace pcm
