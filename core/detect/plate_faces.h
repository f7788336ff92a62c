// Thin plates and webs of beams, whose two faces one threshold takes for one plane.
#pragma once

#include "pcm/detect/station_shifts.h"

#include <functional>
#include <vector>

namespace pcm {

struct PlateOptions {
    double noise = 0, spacing = 0;  // values of the cloud, source units
    std::function<void()> check;    // called at times; may throw
};

// Makes two parts of a narrow plane that has more noise than the cloud and of which the stations see two faces
// (two_faces.h): those that lie apart by far more than the stations do on other planes. Points within its outline that
// belonged to nothing because they are farther than the threshold from the one plane are given to the faces, too. The
// hypotheses of the faces are added to `hypotheses`. `seen`: the planes of `assigned`. One thread. Throws what reading,
// `labels` and options.check throw.
void divide_plates(const ChosenPoints& points, const SeenPlanes& seen, AssignedPoints& assigned,
                   std::vector<Hypothesis>& hypotheses, PointLabels& labels, const PlateOptions& options);

}  // namespace pcm
