// Points of one detected shape that lie on another one, too: strips of a pipe that were found as planes, and cylinders
// through the faces of a post or a beam.
#pragma once

#include "pcm/detect/detect.h"

#include <memory>

namespace pcm {

// Doubts good curved shapes where planes have more of the points on them than they have, and then good planes nearly
// all of whose points lie on one good cylinder, or where that would continue, as near as to the plane, if that cylinder
// has other points, too. `options`: its threads and progress are used; the result does not depend on threads. Needs the
// labels. Throws what reading throws, and Error(cancelled).
void doubt_shared_points(const std::shared_ptr<const Tree>& tree, const DetectOptions& options, DetectReport& report);

}  // namespace pcm
