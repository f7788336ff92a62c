// What a detection must know of a cloud before: its spacing and its noise, from a few places.
#pragma once

#include "pcm/detect/surface_sample.h"

#include <functional>

namespace pcm {

struct CloudSurvey {
    double spacing = 0;  // typical distance of neighbours on surfaces, source units
    double noise = 0;    // standard deviation of points across the smooth surfaces that they lie on, source units
};

// `check` is called now and then; it may throw. Throws what reading throws. Zeros where nothing is known.
CloudSurvey survey_cloud(const ChosenPoints& points, const std::vector<Box3i>& places,
                         const std::function<void()>& check);

}  // namespace pcm
