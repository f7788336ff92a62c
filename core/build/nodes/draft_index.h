// The nodes of an index from the drafts of a build.
#pragma once

#include "pcm/build/nodes/draft.h"
#include "pcm/tree/tree_index.h"

namespace pcm {

// Drafts become nodes, parents first; subtrees without points vanish. Nodes alone: what else an index says is not set.
TreeIndex index_of_drafts(const Draft* root);

}  // namespace pcm
