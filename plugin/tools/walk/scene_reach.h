// Distance from the eye to the nearest visible points, for the walking speed.
#pragma once

#include "plugin/scene/scene_view.h"

#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <optional>

namespace pcm::host {

struct SceneReach {
    double distance = 1;  // to the nearest points; clamped to a range that depends on the document's size, so never 0
    double error = 0;     // the nearest points may be nearer by this
};

// From `place`, in the document's coordinates, to the layers that the view shows. Trees: the points in memory, else the
// boxes of nodes (view/clearance.h). Meshes: the bounding box, and inside it a twentieth of its diagonal. Reads nothing
// from disk and does not block. GUI thread.
SceneReach reach_from(SceneView& view, const Vec3d& place);

struct SceneGround {
    double height = 0;   // along the axis, document's coordinates
    double spacing = 0;  // spacing of the points that it was found from
};

// The lowest ground of the clouds that the view shows under (or over) a place, from the points in memory
// (view/ground.h). `axis`: the vertical one. Clouds whose matrices tilt them are ignored. Reads nothing from disk and
// does not block. GUI thread.
std::optional<SceneGround> ground_under(SceneView& view, const Vec3d& place, std::size_t axis);

// Whether the view's document has point clouds. Their up axis is usually z; that of meshes in MeshLab is y.
bool shows_clouds(SceneView& view);

}  // namespace pcm::host
