// A box as text that is taken from what a user sees: from a view, or from the program's selection of vertices.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/view/first_person.h"
#include "plugin/scene/scene_layer.h"

#include <QString>

#include <optional>
#include <vector>

namespace pcm::host {

// The points p with normal * p + offset >= 0.
struct HalfSpace {
    Vec3d normal{};
    double offset = 0;
};

// What a picture of this aspect (width / height) shows, in the coordinates of the pose: four sides, and what is in
// front of the eye. `fov` is the view's (scene_view.h).
std::vector<HalfSpace> seen_by(const EyePose& pose, float fov, double aspect);

// The smallest box around the part of `box` that lies in all half-spaces. `apex` is a point of their border at which
// more than two planes meet, such as the eye.
Box3d clipped(const Box3d& box, const std::vector<HalfSpace>& spaces, const Vec3d& apex);

// The box, in source coordinates, of what the view shows of the layer: of the parts of its tree, else of its vertices.
// Nothing if it shows none. A little larger than the points, by at most the size of a chunk.
std::optional<Box3d> box_in_view(const SceneLayer& layer, const EyePose& pose, float fov, double aspect);

// The box of the layer's selected vertices, in source coordinates; nothing if none is selected.
std::optional<Box3d> box_of_selection(const SceneLayer& layer);

// The six numbers that parameters take, rounded outwards to about 1/10000 of the box.
QString box_text(const Box3d& box);

}  // namespace pcm::host
