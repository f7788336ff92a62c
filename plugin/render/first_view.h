// Where a view looks from when a cloud is opened in it: obliquely from above, with the cloud filling the view. MeshLab
// itself would look straight down, which shows a map and no shape.
#pragma once

#include "pcm/cloud/geometry.h"

#include <common/interfaces.h>
#include <vcg/math/similarity.h>

#include <optional>
#include <vector>

namespace pcm::host {

// The layer's vertices in the document's coordinates, the layer's matrix included.
std::vector<Vec3d> placed_vertices(const MeshModel& layer);

// MeshLab's trackball for a perspective view of this size in which `points` fill 85 % of the width or of the height,
// seen from the direction of pcmlab render. It turns about what is seen in the centre. The few points that lie far
// outside may be out of view: one in 500 on each side. `fov` is MeshLab's, in degrees, above 5. Nothing without points
// or pixels.
std::optional<vcg::Similarityf> first_view(const std::vector<Vec3d>& points, float fov, int width, int height,
                                           int covered = 0);

}  // namespace pcm::host
