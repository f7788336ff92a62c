// Where a layer's matrix puts the cloud that the layer shows.
#pragma once

#include "pcm/cloud/affine.h"
#include "plugin/meshlab/registry.h"

#include <optional>

namespace pcm::host {

// The map of source coordinates that the layer's matrix is: MeshLab's coordinates are source coordinates minus the
// document's origin. A matrix that was frozen into the sample of the tree, and has not been put back, counts too
// (sample_change.h). Nothing where the cloud is at its place. The matrix is in single precision. GUI thread.
std::optional<Affine> placement_of(const MeshModel& layer, const TreeLayer& tree);

// The layer's matrix alone, about the origin of its document; nothing where it is the identity.
std::optional<Affine> matrix_map_of(const MeshModel& layer);

}  // namespace pcm::host
