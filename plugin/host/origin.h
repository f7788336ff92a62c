// Where MeshLab's coordinates begin.
//
// MeshLab's positions are float: at map coordinates that rounds by half a metre. So all layers of a document that come
// from us are shown relative to one origin, chosen for the first of them; what the user reads is in source coordinates.
#pragma once

#include "pcm/cloud/geometry.h"

namespace pcm::host {

// Zero where float resolves the box's coordinates about as well as any other origin would (so that such a cloud lies on
// other layers as one expects), else the centre of the box in whole units. `box` must not be empty.
Vec3d choose_origin(const Box3d& box);

// Largest distance, along one axis, by which float moves positions of `box` that are stored relative to `origin`.
double float_rounding(const Box3d& box, const Vec3d& origin);

}  // namespace pcm::host
