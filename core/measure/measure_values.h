// The numbers of each kind of measure, for measure.cpp, which has checked the points.
#pragma once

#include "pcm/measure/measure.h"

#include <vector>

namespace pcm {

// Throw Error(invalid_argument) where the points determine no answer.
std::vector<MeasureValue> point_values(const Measure& measure);
std::vector<MeasureValue> distance_values(const Measure& measure);
std::vector<MeasureValue> height_values(const Measure& measure);
std::vector<MeasureValue> angle_values(const Measure& measure);
std::vector<MeasureValue> area_values(const Measure& measure);
std::vector<MeasureValue> plane_values(const Measure& measure);
std::vector<MeasureValue> surface_values(const Measure& measure);
// What is known without a pass over clouds.
std::vector<MeasureValue> volume_values(const Measure& measure);
std::vector<MeasureValue> profile_values(const Measure& measure);

}  // namespace pcm
