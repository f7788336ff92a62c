// Where a view looks from when a cloud is opened in it: core's first view (pcm/view/first_view.h) as MeshLab's
// trackball. MeshLab itself would look straight down, which shows a map and no shape.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

#include "pcm/cloud/geometry.h"
#include "pcm/view/first_view.h"

#include <optional>
#include <vector>

namespace pcm::host {

// The layer's vertices in the document's coordinates, the layer's matrix included.
std::vector<Vec3d> placed_vertices(const MeshModel& layer);

// MeshLab's trackball for the first view of `points`, in a perspective view of this size of which `covered` rows at the
// bottom are hidden. It turns about what is seen in the centre. `poses` are in the points' coordinates. `fov` is
// MeshLab's, in degrees, above 5. Nothing without points or pixels.
std::optional<vcg::Similarityf> first_view(const std::vector<Vec3d>& points, float fov, int width, int height,
                                           int covered = 0, const std::vector<ScanPose>& poses = {});

}  // namespace pcm::host
