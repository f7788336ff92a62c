// What the filters that write a tree have in common: where the result goes, and the layers that show it.
#pragma once

#include "pcm/update/target.h"
#include "plugin/filter/filter.h"
#include "plugin/scene/scene.h"

#include <filesystem>
#include <functional>
#include <vector>

namespace pcm::host {

// Adds a layer that shows the tree `folder`, with the matrix of `like` (null: none). A tree without points gets no
// layer; the log says so.
void add_tree_layer(const FilterRun& run, const std::filesystem::path& folder, const SceneLayer* like = nullptr);

// Runs `show` after the filter has changed the tree: what fails then is a warning, since the tree is changed already.
void show_afterwards(const FilterRun& run, const std::function<void()>& show);

// A copy gets a layer in place of the one that shows the tree `made_of` (scene/result_layer.h); layers that show a tree
// changed in place are loaded again.
void show_result(const FilterRun& run, const std::filesystem::path& made_of, const TargetChoice& target);
// A tree that takes the place of these layers, and has their matrices applied.
void show_moved_result(const FilterRun& run, const std::filesystem::path& folder, std::vector<SceneLayer*> replaced);

}  // namespace pcm::host
