// The nodes of an index from the drafts of a build.
#pragma once

#include "pcm/build/nodes/draft.h"
#include "pcm/tree/tree_index.h"

namespace pcm {

// Drafts become nodes, parents first; subtrees without points are left out. Sets only the nodes of the index.
TreeIndex index_of_drafts(const Draft* root);

}  // namespace pcm
