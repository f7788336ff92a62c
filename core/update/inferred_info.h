// The properties of a tree inferred from its chunks, when index and about.pct are lost.
#pragma once

#include "pcm/tree/tree.h"
#include "pcm/update/chunk_scan.h"

#include <vector>

namespace pcm {

// For a tree whose newest chunks are `nodes`: grid, attributes, whether coordinates are wide, levels and their
// spacings. The type of the positions and the kind of sampling are guesses that guarantee no more than the points
// fulfil. Metadata, sources and all counts are missing.
TreeInfo infer_info(const ChunkKind& kind, const std::vector<PartNode>& nodes);

}  // namespace pcm
