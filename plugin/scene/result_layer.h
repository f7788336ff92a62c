// The layers of trees that filters and tools have written: one place that adds such a layer, and that shows a result
// instead of what it was made of. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm::host {

// Adds a layer that shows the tree `folder`, makes it the current one and returns lines for the log; a tree without
// points gets none. `like`: the new layer gets the matrix of this one; null: none. Throws what opening the tree and
// reading chunks throws; the document then has no new layer.
std::vector<std::string> add_layer_of(Scene& scene, const std::filesystem::path& folder,
                                      const SceneLayer* like = nullptr);

// The layer that shows the tree: the current one, else the first visible one, else the first. Null: none does.
SceneLayer* layer_showing(Scene& scene, const std::filesystem::path& folder);

// A result that takes the place of the layers it was made of.
struct TreeResult {
    std::filesystem::path folder;
    std::vector<SceneLayer*> replaced;  // may be empty; none is null
    bool same_place = true;             // the result has the coordinates of the first of them, so its matrix holds too
};

// Adds the layer of the result, hides those that it replaces and clears their selected points (undo brings these
// back). A result without points replaces nothing. Returns lines for the log; throws as add_layer_of().
std::vector<std::string> show_result(Scene& scene, const TreeResult& result);

// The same for a tree that was made of one tree; where it was changed in place (`made_of` is `folder`), its layers are
// loaded again, which ends their selections.
std::vector<std::string> show_result(Scene& scene, const std::filesystem::path& folder,
                                     const std::filesystem::path& made_of);

}  // namespace pcm::host
