// The points of a unit and those around it, gathered out of the chunks.
#pragma once

#include "pcm/knn/neighbourhoods.h"
#include "pcm/knn/unit_search.h"

#include <cstdint>

namespace pcm {

// Positions of a unit's points and of the points around its box, by their numbers in the unit.
struct GatheredPoints {
    NeighbourhoodUnit unit;
    Box3i box;     // the unit's
    Box3i loaded;  // all points of the cloud in here are there
    Vec3i origin{};
    SearchPositions positions;

    // No point of the cloud that was not loaded is nearer than this to a point of the unit: infinite where all are
    // loaded. Source units.
    double reach(std::uint32_t number, const Box3i& cloud) const;
    Vec3i grid(std::uint32_t number) const;
    // Offsets of points from another along one axis, source units: the differences in steps are exact.
    void put_offsets(std::size_t axis, std::uint32_t from, const std::uint32_t* to, std::size_t count,
                     double* offsets) const;
};

// `box` grown by a margin (source units) on all sides, but not beyond the cloud.
Box3i box_around(const Box3i& box, double margin, const TreeInfo& info);

// Loads the points in `box`, which become the unit, and those that lie up to `margin` (source units) outside of it.
// `columns` are those that the unit's chunks are to have. Throws what reading throws.
GatheredPoints gather_unit(L2Cache& cache, const Box3i& box, double margin, const ColumnSet& columns);

}  // namespace pcm
