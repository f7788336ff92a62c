// Makes the deletion of a sample's vertices one of the cloud's points.
#pragma once

#include "pcm/cloud/region.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/scene.h"

#include <string>
#include <vector>

namespace pcm::host {

// Number of the cloud's points in a region, as text: counted, or "about ..." where counting would read too much.
std::string points_in(const LayerCloud& tree, const Region& region);

// Deletes the points in place; the layers of the scene that show the tree are loaded again. Returns lines for the
// log. Throws what erase_points() throws, and Error(cancelled).
std::vector<std::string> delete_points_in(Scene& scene, const LayerCloud& tree, const Region& region,
                                          Operation& operation);

}  // namespace pcm::host
