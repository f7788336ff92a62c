// The edges and handles of a clip box as annotations.
#pragma once

#include "plugin/scene/annotations.h"
#include "plugin/tools/clip/box_handles.h"

#include <optional>
#include <vector>

namespace pcm::host {

// `lit`: the handle under the cursor, or the one that is dragged. A box that is switched off is grey.
std::vector<Annotation> drawing_of(const ClipBox& box, const std::optional<BoxHandle>& lit);

}  // namespace pcm::host
