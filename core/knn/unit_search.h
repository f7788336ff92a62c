// The k nearest neighbours of many points among many points that lie in memory: the kernel of neighbourhoods.h.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace pcm {

enum class NeighbourBackend : std::uint8_t;  // neighbourhoods.h

// Positions as grid steps relative to one origin: in `narrow` where 31 bits and the sign hold all of them, else in
// `wide`; the other is empty. scale: source units per step, of each axis; positive.
struct SearchPositions {
    std::array<std::vector<std::int32_t>, 3> narrow;
    std::array<std::vector<std::int64_t>, 3> wide;  // magnitudes below 2^62
    Vec3d scale{1, 1, 1};
    bool is_wide() const { return !wide[0].empty(); }
    std::size_t size() const { return is_wide() ? wide[0].size() : narrow[0].size(); }
};

// The neighbours of a few points, as a search hands them out; valid during the call.
struct FoundNeighbours {
    const std::uint32_t* points = nullptr;  // [size] whose neighbours they are
    std::size_t size = 0;
    std::size_t stride = 0;                     // step of the next two arrays, from one point to the next
    const std::uint32_t* neighbours = nullptr;  // [size * stride] nearest first
    const double* squared = nullptr;            // [size * stride] exact squared distances, ascending, source units
    const std::uint32_t* counts = nullptr;      // [size] of neighbours
};

struct UnitSearchOptions {
    std::size_t neighbours = 16;                                    // the point itself is not counted
    double max_distance = std::numeric_limits<double>::infinity();  // source units, inclusive
};

// The result is that of comparing all pairs with squared distances (dx * dx + dy * dy) + dz * dz in double, where dx is
// the exact difference in steps times the scale, both rounded once; equal squares are ordered by position, x first. So
// it is for any extent, any number of points at one place (of which any may be chosen), and more neighbours than there
// are points. What other points there are, and the instructions used (system/cpu.h), make no difference.
class UnitSearch {
public:
    virtual ~UnitSearch() = default;
    // Calls `found` once for each of `queries` (indices of positions, each once; all positions when null), some at a
    // time, neighbours in space together.
    virtual void search(const std::vector<std::uint32_t>* queries, const UnitSearchOptions& options,
                        const std::function<void(const FoundNeighbours&)>& found) const = 0;
};

// At most 2^32 - 64 positions, which are needed during the construction only. One thread makes it; then any number of
// threads may search. Bytes per position in addition to the given ones: 18, and 34 while it is made; of wide ones 31,
// and 64. Four more once a search was for some queries only. Throws Error(invalid_argument) for a wrong PCM_SIMD
// (system/cpu.h).
std::unique_ptr<UnitSearch> make_unit_search(SearchPositions positions);

// The same by the chosen backend. FLANN is not exact: see flann_search.h, also for its errors.
std::unique_ptr<UnitSearch> make_unit_search(SearchPositions positions, NeighbourBackend backend);

}  // namespace pcm
