// The errors of detected shapes in a cloud of several stations, which their registration has left apart: as those of a
// shape at a place (place/station_errors.h), but for all shapes in one pass over their points.
#pragma once

#include "pcm/detect/detect.h"

#include <memory>

namespace pcm {

// Adds the effect of the stations to the errors of all primitives, and takes what errors along the rays of a scanner
// have done to curved ones, whose thresholds are enlarged by as much: each point with a label stays within. Where the
// points name their stations, the spread of these is one number for the whole cloud. It is found from all good shapes
// with points of several stations, and from the surfaces around a few of them (agreeing_evidence()). Sets `stations`;
// good fits whose size is then uncertain become doubtful. `options`: its registration, threads and progress are used;
// the result does not depend on threads. Throws what reading throws, and Error(cancelled).
void add_errors_of_stations(const std::shared_ptr<const Tree>& tree, const DetectOptions& options,
                            DetectReport& report);

}  // namespace pcm
