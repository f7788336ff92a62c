// What the filters that work on selected points have in common.
#pragma once

#include "pcm/filter/set_changes.h"
#include "pcm/query/point_set.h"
#include "plugin/filter/filter.h"
#include "plugin/meshlab/2020/registry.h"

#include <filesystem>
#include <memory>

namespace pcm::host {

// The current layer, which shows a tree, and its selected points, of which there are some. Throws
// Error(invalid_argument) otherwise, with what to do.
struct SelectedLayer {
    MeshModel& layer;
    TreeLayer shown;
    std::shared_ptr<const PointSet> points;
};
std::pair<MeshModel*, TreeLayer> layer_with_tree(MeshDocument& document);
SelectedLayer selected_layer(MeshDocument& document);

// "Output" and "InPlace", and "MemoryMB" and "Threads", as the library takes them; without progress.
void add_set_change_parameters(RichParameterList& parameters);
SetChangeOptions set_change_options_of(const RichParameterList& parameters);

// The end of all help texts of these filters.
QString about_selections();

}  // namespace pcm::host
