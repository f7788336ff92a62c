// The camera of the picture that a view shows, and which points are in that picture. GUI thread.
#pragma once

#include "pcm/cloud/condition.h"
#include "pcm/view/camera.h"

#include <optional>
#include <vector>

class GLArea;

namespace pcm::host {

// In MeshLab's coordinates: Camera::origin is 0, and what it maps are source coordinates minus the document's origin.
// Its size is in the pixels of the screen, devicePixelRatio() of which are one of Qt's. Nothing until the view has
// painted a cloud.
std::optional<Camera> camera_of(const GLArea& area);

// Called by what paints clouds, with the camera of each picture but those of snapshots.
void keep_camera(GLArea& area, const Camera& camera);

// What clouds are drawn in a view, and how.
struct ShownClouds {
    std::vector<int> layers;       // mesh ids of those whose clouds are in the picture
    std::vector<Condition> where;  // only points that meet these are shown; those on attributes that a cloud lacks, or
                                   // that name no component of several, leave that cloud as it is
    double size_scale = 0;         // radii of splats for sizes of points; 0: squares of a few pixels
    bool fitted = false;           // these depend on the points' surroundings
};

// Nothing until the view has painted.
std::optional<ShownClouds> shown_in(const GLArea& area);

// Called with keep_camera().
void keep_shown(GLArea& area, ShownClouds shown);

}  // namespace pcm::host
