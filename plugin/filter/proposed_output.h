// Names of results that dialogs propose: next to the cloud that they are made of, and free.
#pragma once

#include "plugin/scene/parameters.h"
#include "plugin/scene/scene.h"

#include <string>

namespace pcm::host {

// Gives the parameter "Output", or "OutputFile" where `ending` is that of a file, a value that names the result of a
// filter: of the tree that the parameter "Tree" names, else of the current layer's, else (of a filter without "Tree")
// of the first visible one. While the dialog is open the proposal follows the tree and names that were used, until the
// user types another name. Does nothing where there is no window: an empty output of a script stays one.
void propose_output(Parameters& parameters, Scene& scene, const std::string& ending);

// A filter has been applied: proposals that name something that exists now are replaced.
void renew_proposals();

}  // namespace pcm::host
