// A tree that is moved into a new one.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/cloud/affine.h"
#include "pcm/tree/tree.h"

#include <filesystem>
#include <memory>
#include <vector>

namespace pcm::host {

// Writes the tree, moved by the maps one after the other, in double. The sampling of its levels stays that of the tree,
// whatever `options` say. Throws Error(invalid_argument) where `output` is the tree itself, and what build_tree() and
// TransformedReader throw.
BuildReport write_moved_tree(const std::shared_ptr<const Tree>& tree, const std::vector<Affine>& maps,
                             const std::filesystem::path& output, BuildOptions options);

}  // namespace pcm::host
