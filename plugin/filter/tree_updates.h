// Filters that change trees: appending, deleting, compacting.
#pragma once

#include <common/interfaces.h>

#include <string>
#include <vector>

namespace pcm::host {

// Each returns what the log should say. The tree is the folder of the parameter "Tree", or that of the current layer.
// Layers that show a tree which is changed in place are shown anew.
std::vector<std::string> append_to_tree(MeshDocument& document, const RichParameterList& parameters,
                                        vcg::CallBackPos* callback);
std::vector<std::string> delete_from_tree(MeshDocument& document, const RichParameterList& parameters,
                                          vcg::CallBackPos* callback);
std::vector<std::string> compact_tree_in_place(MeshDocument& document, const RichParameterList& parameters,
                                               vcg::CallBackPos* callback);

void add_append_parameters(RichParameterList& parameters);
void add_delete_parameters(RichParameterList& parameters);
void add_compact_parameters(RichParameterList& parameters);

}  // namespace pcm::host
