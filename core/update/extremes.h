// The extreme points of a tree after a change of some of its nodes.
#pragma once

#include "pcm/build/bins/observed.h"
#include "pcm/tree/tree.h"

#include <array>
#include <set>

namespace pcm {

// The points with the smallest x, largest x, smallest y, ... as TreeInfo has them: of all points of `tree` but those in
// the chunks of `changed`, and of those that `kept` saw. `box` is tight around all of them, and there is at least one.
// Reads positions of the few nodes that can hold such a point.
std::array<Vec3i, 6> find_extremes(const Tree& tree, const std::set<NodeId>& changed, const Observed& kept,
                                   const Box3i& box);

}  // namespace pcm
