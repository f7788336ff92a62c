// The points of a cloud that has its levels already and keeps them, for the choice of levels next to them.
#pragma once

#include "pcm/build/levels/lattice.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace pcm {

// The levels of a cloud to which points are added.
template <class Coord>
struct GivenLevels {
    using Visit = std::function<void(const Point<Coord>* points, std::size_t count)>;

    std::vector<double>
        spacings;  // as LevelSampler::spacings() (level_sampler.h), on the same grid; at least one that is not 0
    // Calls visit() with every point of levels first..last in the box [low, high], in any order and pieces of any size;
    // points of these levels outside of the box do no harm. The rest is never asked for. Any thread, several at once.
    std::function<void(const Point<Coord>& low, const Point<Coord>& high, std::size_t first, std::size_t last,
                       const Visit& visit)>
        list;
};

}  // namespace pcm
