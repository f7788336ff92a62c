#include "pcm/filter/search_positions.h"

#include <cstdint>
#include <limits>

namespace pcm {

UnitPositions positions_of(const NeighbourhoodUnit& unit, const Grid& grid)
{
    Box3i box;
    for (const NeighbourhoodUnit::Part& part : unit.parts)
        for (const std::uint32_t i : part.indices) box.extend(part.chunk->positions->grid(i));
    UnitPositions result;
    result.steps.scale = grid.scale;
    if (box.empty()) return result;
    result.origin = box.min;
    bool narrow = true;
    for (std::size_t a = 0; a < 3; ++a)
        narrow = narrow && static_cast<std::uint64_t>(box.max[a]) - static_cast<std::uint64_t>(box.min[a]) <=
                               std::uint64_t(std::numeric_limits<std::int32_t>::max());
    for (std::size_t a = 0; a < 3; ++a) {
        if (narrow)
            result.steps.narrow[a].reserve(unit.points);
        else
            result.steps.wide[a].reserve(unit.points);
        for (const NeighbourhoodUnit::Part& part : unit.parts)
            for (const std::uint32_t i : part.indices) {
                const std::int64_t step = part.chunk->positions->grid(i, a) - box.min[a];
                if (narrow)
                    result.steps.narrow[a].push_back(static_cast<std::int32_t>(step));
                else
                    result.steps.wide[a].push_back(step);
            }
    }
    return result;
}

}  // namespace pcm
