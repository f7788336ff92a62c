// How a cloud is divided into boxes that are computed one after the other.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <vector>

namespace pcm {

// Boxes that share no grid position and hold all points of the tree, each about `points_per_unit` or fewer, as far as
// the boxes and numbers of points of the nodes show; points at one place stay together. Neighbours in the list lie near
// each other. No chunk is read.
std::vector<Box3i> plan_units(const Tree& tree, std::uint64_t points_per_unit);

// About how many points lie in a box, by the same means.
double estimated_points(const Tree& tree, const Box3i& box);

}  // namespace pcm
