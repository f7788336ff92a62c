// MeshLab's camera and ours, one made from the other.
//
// MeshLab (2020.09, src/meshlab/glarea.cpp: setView) looks from (0, 0, c) at the origin of a space into which the
// trackball brings the scene: p -> sca * R * (p + tra), its centre being the origin always. c is 1.75 / tan(fov / 2),
// so that 1.75 to both sides of the origin are as high as the view; an orthographic view shows as much, has c = 8, and
// is said by fov = 5, the smallest that MeshLab allows.
//
// So the eye fixes R and, given the scale, tra; the scale is free in a perspective view and decides where the origin,
// about which the trackball turns, lies in front of the eye: c / sca, EyePose::focus. The near plane is clipRatioNear
// (0.1) of it. In an orthographic view it is the size of what is seen.
#pragma once

#include "pcm/view/first_person.h"

#include <vcg/math/similarity.h>

namespace pcm::host {

// In the document's coordinates.
EyePose pose_of(const vcg::Similarityf& track, float fov);

// Rounded to single precision, which is what MeshLab has. The pose's own projection must be the fov's.
vcg::Similarityf trackball_of(const EyePose& pose, float fov);

bool is_orthographic(float fov);

}  // namespace pcm::host
