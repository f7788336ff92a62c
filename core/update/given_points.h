// The existing points of a tree, for choosing the levels of points that are added.
#pragma once

#include "pcm/build/levels/level_sampler.h"
#include "pcm/tree/tree.h"

#include <memory>

namespace pcm {

// The levels of a tree in the form that the sampler asks for: chunk by chunk, only segments that touch its box and are
// of its levels.
template <class Coord>
GivenLevels<Coord> given_levels(std::shared_ptr<const Tree> tree);

extern template GivenLevels<std::uint32_t> given_levels(std::shared_ptr<const Tree> tree);
extern template GivenLevels<std::uint64_t> given_levels(std::shared_ptr<const Tree> tree);

}  // namespace pcm
