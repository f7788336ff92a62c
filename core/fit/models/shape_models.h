// The models; a row of shape_models.cpp each.
#pragma once

#include "pcm/fit/models/shape_model.h"

namespace pcm {

const ShapeModel& plane_model();
const ShapeModel& cylinder_model();
const ShapeModel& sphere_model();
const ShapeModel& cone_model();
const ShapeModel& torus_model();

}  // namespace pcm
