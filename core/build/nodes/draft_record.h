// Nodes in the making as bytes, in records of finished work.
#pragma once

#include "pcm/build/nodes/draft.h"

#include <array>
#include <functional>

namespace pcm {

class ByteReader;
class ByteWriter;

// One node, without those below it. get_draft() sets `has_child`; the children are not linked.
void put_draft(ByteWriter& out, const Draft& draft);
Draft* get_draft(ByteReader& in, DraftStore& drafts, std::array<bool, 2>& has_child);

// A node and all below it. get_subtree() calls `read` for each, parents first, and throws Error(corrupt) for what is
// not a tree.
void put_subtree(ByteWriter& out, const Draft& draft);
Draft* get_subtree(ByteReader& in, DraftStore& drafts, const std::function<void(Draft&)>& read);

}  // namespace pcm
