// What chunks tell of their tree when nothing else does.
#pragma once

#include "pcm/tree/tree.h"
#include "pcm/update/chunk_scan.h"

#include <vector>

namespace pcm {

// Of a tree whose newest chunks are `nodes`: grid, attributes, whether coordinates are wide, levels and their spacings.
// Type of positions and kind of sampling are guesses that promise no more than the points keep; metadata, sources and
// all counts are missing.
TreeInfo infer_info(const ChunkKind& kind, const std::vector<PartNode>& nodes);

}  // namespace pcm
