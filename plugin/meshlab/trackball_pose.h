// Conversion between MeshLab's camera and ours.
//
// MeshLab (2020.09, src/meshlab/glarea.cpp: setView) looks from (0, 0, c) at the origin of a space into which the
// trackball maps the scene: p -> sca * R * (p + tra); its centre is always the origin. c is 1.75 / tan(fov / 2), so
// that the view spans 1.75 above and below the origin. An orthographic view shows the same height and has c = 8; it is
// marked by fov = 5, the smallest value that MeshLab allows.
//
// So the eye determines R and, given the scale, tra. In a perspective view the scale is free: it determines the
// distance c / sca (EyePose::focus) of the origin, about which the trackball turns, in front of the eye. The near plane
// is at clipRatioNear (0.1) of this distance. In an orthographic view the scale is the size of the visible part.
#pragma once

#include "plugin/meshlab/meshlab.h"
#include "plugin/scene/scene_view.h"

#include "pcm/view/first_person.h"

namespace pcm::host {

// In the document's coordinates.
EyePose pose_of(const vcg::Similarityf& track, float fov);

// Rounded to single precision, as MeshLab stores it. The pose must have the projection that fov implies.
vcg::Similarityf trackball_of(const EyePose& pose, float fov);

bool is_orthographic(float fov);

}  // namespace pcm::host
