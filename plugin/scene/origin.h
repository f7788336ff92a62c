// The origin of MeshLab's coordinates.
//
// MeshLab's positions are float, which at map coordinates rounds by half a metre. So all clouds of a document are shown
// relative to one origin, chosen for the first of them. Numbers that the user reads are in source coordinates.
#pragma once

#include "pcm/cloud/geometry.h"

namespace pcm::host {

// Zero if float resolves the box's coordinates about as well as with any other origin, so that such a cloud is aligned
// with other layers as expected; else the centre of the box in whole units. `box` must not be empty.
Vec3d choose_origin(const Box3d& box);

// Largest rounding error along one axis when positions in `box` are stored as float relative to `origin`. Source units.
double float_rounding(const Box3d& box, const Vec3d& origin);

}  // namespace pcm::host
