// Builds a tree and changes it before it gets its name.
#pragma once

#include "pcm/build/builder.h"

#include <functional>

namespace pcm {

// Changes the tree in `folder`, which has no name yet, and leaves nothing of it open. `report`: the build's report, for
// warnings.
using WorkOnTree = std::function<void(const std::filesystem::path& folder, BuildReport& report)>;

// As build_tree(), but `then` runs before the tree gets its name: when it throws, nothing has that name, and an
// interrupted build that is resumed runs all of it. Errors and warnings of `then` name `output` in place of the working
// folder. `outcome.seconds` is the time of the build alone. `then` may be empty.
BuildReport build_tree_then(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                            const BuildOptions& options, const WorkOnTree& then);

}  // namespace pcm
