// Draws ordinary layers as point clouds.
//
// A layer whose vertices are the cloud (a small file, the result of a filter) gets a drawn copy: a tree of its vertices
// in the cache folder (tree_cache.h), which only views use. For MeshLab's filters, for saving and for scripts the layer
// is not changed. When its vertices change, views show MeshLab's own drawing until there is a new copy.
#pragma once

#include "pcm/system/progress.h"
#include "plugin/meshlab/registry.h"

#include <cstddef>
#include <string>

namespace pcm::host {

// Copies of layers up to this size take about a second, and are made without a click.
inline constexpr std::size_t most_copied_unasked = 4'000'000;

// Why the layer cannot be drawn as a point cloud; empty if it can: it has vertices, and neither faces nor edges.
std::string why_not_drawn(const MeshModel& layer);

// Makes the copy and attaches it. Throws Error(invalid_argument) with the reason above, Error(cancelled), and what
// building a tree throws; the layer is then drawn by MeshLab.
void draw_as_cloud(MeshModel& layer, const ProgressFunction& progress);

// Whether the layer has a drawn copy that is not of its present vertices. A glance looks at some of them only.
bool is_outdated(const MeshModel& layer, bool glance);

}  // namespace pcm::host
