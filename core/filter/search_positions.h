// The positions of a unit's points, as the search in memory takes them.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/knn/unit_search.h"

namespace pcm {

struct UnitPositions {
    SearchPositions steps;  // positions by number in the unit, relative to the origin
    Vec3i origin{};         // on the grid: the smallest coordinates
};

// The extent of the unit must be below 2^62 steps.
UnitPositions positions_of(const NeighbourhoodUnit& unit, const Grid& grid);

}  // namespace pcm
