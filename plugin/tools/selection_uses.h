// What is done with the selected points of a layer: extracted, deleted, classified, saved as an attribute. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include <QString>

namespace pcm::host {

enum class SelectionUse {
    to_layer,  // a new tree, shown in a new layer
    to_file,   // a file of any format
    remove,    // from the cloud: a copy without the points, or in place
    classify,
    save,  // as an attribute: 1 for selected points, 0 for others
};

// Asks for what is missing, does it (Esc cancels) and returns what was done, for the user; nothing where the user has
// cancelled a question. Throws Error(invalid_argument) for a layer without selected points and for an ordinary layer,
// whose points are MeshLab's, and what the functions of select/ throw.
QString use_selected(SceneView& view, SceneLayer& layer, SelectionUse use);

// The same for all points of the layer that the view shows: clip box, hidden classes and conditions choose them. Only
// to_layer and to_file. Throws Error(invalid_argument) also where none is shown.
QString use_shown(SceneView& view, SceneLayer& layer, SelectionUse use);

}  // namespace pcm::host
