// What a detection must know of a cloud before: its spacing and its noise, from a few places.
#pragma once

#include "pcm/detect/surface_sample.h"

#include <functional>

namespace pcm {

struct CloudSurvey {
    double spacing = 0;      // typical distance of neighbours on surfaces, source units
    double noise = 0;        // standard deviation of points across the smooth surfaces that they lie on, source units
    double least_noise = 0;  // the same where it is low (SurveyTuning::quiet_quantile)
};

// Whether points at one position count as one. They do in no cloud that has few of them: then a survey that counts each
// position once would see less noise on surfaces that the grid's steps are coarse for.
enum class Repeated { counted, once };

// `check` is called now and then; it may throw. Throws what reading throws. Zeros where nothing is known: of a cloud
// whose points are repeated several times, `counted`, too.
CloudSurvey survey_cloud(const ChosenPoints& points, const std::vector<Box3i>& places, Repeated repeated,
                         const std::function<void()>& check);

// The part of the cloud whose noise is far below that of the whole: what a dense scan within one from farther away is.
// Among `regions`, which share no position and hold all points, by the noise of small places in each; `groups`, larger
// ones, fill gaps. The whole cloud where there is no such part, or nothing else. Throws what reading and `check` throw.
CloudPart quiet_part(const ChosenPoints& points, const std::vector<Box3i>& regions, const std::vector<Box3i>& groups,
                     const CloudSurvey& whole, Repeated repeated, const std::function<void()>& check);

}  // namespace pcm
