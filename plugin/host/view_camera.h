// The camera of the picture that a view shows. GUI thread.
#pragma once

#include "pcm/view/camera.h"

#include <optional>

class GLArea;

namespace pcm::host {

// In MeshLab's coordinates: Camera::origin is 0, and what it maps are source coordinates minus the document's origin.
// Its size is in the pixels of the screen, devicePixelRatio() of which are one of Qt's. Nothing until the view has
// painted a cloud.
std::optional<Camera> camera_of(const GLArea& area);

// Called by what paints clouds, with the camera of each picture but those of snapshots.
void keep_camera(GLArea& area, const Camera& camera);

}  // namespace pcm::host
