// Buttons in the dialogs that MeshLab makes of parameters: files and folders are picked, and a box is taken from the
// view, from the selection or from the clip box. MeshLab's own fields for files take one existing file and ignore what
// is typed; ours stay fields of text, with their type in scripts, and the button writes into them.
#pragma once

#include "plugin/scene/parameters.h"
#include "plugin/scene/scene.h"

namespace pcm::host {

// The parameters that get buttons, by name: Inputs (files and folders), Tree, TreeBefore and Trees (tree folders),
// Output and PointsOutput (trees, or files too), OutputFile, ListFile and PairsFile (files), TreeFolder (a folder),
// Box. Fields that are empty say in grey what that means (Parameter::empty). Called where MeshLab asks for the
// parameters of a dialog, which it shows afterwards; does nothing where there is no window. `scene`: boxes are taken
// from its current layer; null: there are no buttons for boxes.
void add_field_buttons(const Parameters& parameters, Scene* scene);

}  // namespace pcm::host
