// Names of results that dialogs propose: next to the cloud that they are made of, and free.
#pragma once

#include <common/interfaces.h>

#include <filesystem>
#include <string>

namespace pcm::host {

// A path next to `cloud`, whose name without extension is that of the cloud and `ending` ("-normals.pct"): NAME-normals
// for NAME and for NAME-normals itself. A number is added where there is something of this name. In the user's home
// where the cloud's folder cannot be written.
std::filesystem::path free_path(const std::filesystem::path& cloud, const std::string& ending);

// Gives the parameter "Output", or "OutputFile" where `ending` is that of a file, a value that names the result of a
// filter: of the tree that the parameter "Tree" names, else of the current layer's, else (of a filter without "Tree")
// of the first visible one. While the dialog is open the proposal follows the tree and names that were used, until the
// user types another name. Does nothing where there is no window: an empty output of a script stays one.
void propose_output(RichParameterList& parameters, MeshDocument& document, const std::string& ending);

// A filter has been applied: proposals that name something that exists now are replaced.
void renew_proposals();

}  // namespace pcm::host
