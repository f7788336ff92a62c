// The points that a tree has already, for choosing the levels of those that are added.
#pragma once

#include "pcm/build/levels/level_sampler.h"
#include "pcm/tree/tree.h"

#include <memory>

namespace pcm {

// Levels of the tree, as the sampler asks for them: chunk by chunk, of each only the pieces in the box and of the
// levels asked for.
template <class Coord>
GivenLevels<Coord> given_levels(std::shared_ptr<const Tree> tree);

extern template GivenLevels<std::uint32_t> given_levels(std::shared_ptr<const Tree> tree);
extern template GivenLevels<std::uint64_t> given_levels(std::shared_ptr<const Tree> tree);

}  // namespace pcm
