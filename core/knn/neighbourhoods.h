// The k nearest neighbours of every point of a cloud, block by block, in bounded memory, for whatever is computed from
// them: radii, normals, mean distances. query/nearest.h answers for single points instead.
//
// The cloud is divided into units: boxes that share no point and hold about as many points each. Points of all levels
// and parts that lie in a unit's box are computed together; points around the box are loaded as far as they can be
// neighbours. Neighbours are exact: those of the whole cloud, by the double distance between grid positions,
// (dx * dx + dy * dy) + dz * dz with dx in source units. Points at equal distance are ordered by position, x first. So
// the offsets that a visitor gets, and their order, depend on the cloud alone: not on threads, memory or units.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/progress.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// The searcher inside a unit.
enum class NeighbourBackend : std::uint8_t {
    own,    // exact; the fastest that the processor can run
    flann,  // the FLANN library on single-precision offsets from the unit's centre; for comparison
};

inline constexpr std::size_t most_neighbours = 1024;

// A point of the cloud.
struct PointPlace {
    NodeId node = no_node;
    std::uint32_t index = 0;  // in the node's chunk
    bool operator==(const PointPlace& o) const { return node == o.node && index == o.index; }
    bool operator<(const PointPlace& o) const { return node != o.node ? node < o.node : index < o.index; }
};

// Enough that few points of a unit lie near its border, and few enough that a unit fits into a processor's caches and
// into the minimum memory of filters.
inline constexpr std::uint64_t usual_unit_points = 100'000;
// What a thread takes for a point of its unit: positions twice, the search, the results of visitors.
inline constexpr std::uint64_t bytes_per_unit_point = 160;
// The minimum memory of a process with a filter on neighbourhoods: a unit, what it is gathered from, the results,
// and the process itself. Measured on 10 M points, where the allocator returns large blocks
// (system/peak_memory.h): 63 MB for outliers, 91 MB for normals whose sides agree.
inline constexpr std::uint64_t least_filter_memory = std::uint64_t(64) << 20;
inline constexpr std::uint64_t least_attribute_memory = std::uint64_t(96) << 20;
// Shares of a filter's memory limit: for the cache, and for boxes of blocks in searches for single points (BlockCache).
std::uint64_t cache_share(std::uint64_t memory_bytes);
std::uint64_t block_share(std::uint64_t memory_bytes);

struct NeighbourhoodOptions {
    std::size_t neighbours = 16;  // k, 1 to most_neighbours; the point itself is not counted
    double max_distance = std::numeric_limits<double>::infinity();  // source units, inclusive
    ColumnSet columns = ColumnSet::only_positions();                // columns of the units' chunks
    bool numbers = false;  // whether visitors get the numbers of neighbours (Neighbourhoods::neighbours)
    // For the units of all threads, in addition to the cache: where it is short, fewer threads run; at least one does.
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    // About as many points have a unit. Not by the memory, so that what depends on units does not depend on it.
    std::uint64_t unit_points = usual_unit_points;
    unsigned threads = 0;  // 0: one per processor
    NeighbourBackend backend = NeighbourBackend::own;
    // Where several processes share the units: the number of the next unit for this one (from plan_units(), in
    // unit_plan.h), their number or more when none is left. Any thread. Empty: all units, in their order.
    std::function<std::size_t()> next_unit;
    ProgressFunction progress;
    std::string stage = "Searching neighbours";  // stage of the progress
    double begin = 0, end = 1;                   // range of the progress
};

// Points of the cloud that are computed together, by one thread.
struct NeighbourhoodUnit {
    // Some points of a node.
    struct Part {
        NodeId node = no_node;
        L2Cache::Handle chunk;               // with the asked columns; null for points around the unit
        std::vector<std::uint32_t> indices;  // indices of the points in the chunk, ascending
        std::uint32_t first = 0;             // number, in the unit, of the first of them; they are consecutive
    };
    std::size_t unit = 0;  // its number
    std::vector<Part> parts;
    std::uint32_t points = 0;  // number of points of all parts: the numbers in the unit are 0 .. points - 1
    // Points of other units, with the numbers from `points` on: those that Neighbourhoods::neighbours may name, in the
    // same call of visit(). Only with NeighbourhoodOptions::numbers.
    std::vector<Part> around;

    const Part& part_of(std::uint32_t number) const;
    PointPlace place_of(std::uint32_t number) const
    {
        const Part& part = part_of(number);
        return {part.node, part.indices[number - part.first]};
    }
    // The number, in the unit or around it, that a point gets; one that it has already where it is of the unit.
    std::uint32_t add_around(const PointPlace& place);
};

// Some points of a unit and their neighbours.
class Neighbourhoods {
public:
    std::size_t size() const { return numbers.size(); }
    std::uint32_t number(std::size_t i) const { return numbers[i]; }  // in the unit
    // How many neighbours: fewer than k where the cloud, or max_distance, leaves no more.
    std::size_t count(std::size_t i) const { return counts[i]; }
    // The neighbours of point i, nearest first: their offsets from the point, source units, and squared distances.
    const double* dx(std::size_t i) const { return offsets[0].data() + i * stride; }
    const double* dy(std::size_t i) const { return offsets[1].data() + i * stride; }
    const double* dz(std::size_t i) const { return offsets[2].data() + i * stride; }
    const double* squared(std::size_t i) const { return squares.data() + i * stride; }
    // Their numbers in the unit, from unit.points on for points of other units. Only with
    // NeighbourhoodOptions::numbers.
    const std::uint32_t* neighbours(std::size_t i) const { return neighbour_numbers.data() + i * stride; }

    std::vector<std::uint32_t> numbers;
    std::vector<std::uint32_t> counts;
    std::size_t stride = 0;
    std::array<std::vector<double>, 3> offsets;
    std::vector<double> squares;
    std::vector<std::uint32_t> neighbour_numbers;
};

// What is computed. Each visitor serves one thread.
class NeighbourhoodVisitor {
public:
    virtual ~NeighbourhoodVisitor() = default;
    virtual void begin(const NeighbourhoodUnit&) {}
    // Each point of the unit comes once, in any order.
    virtual void visit(const NeighbourhoodUnit& unit, const Neighbourhoods& some) = 0;
    // All of the unit's points were visited. Other threads may run end() of other units, which may have points of the
    // same nodes.
    virtual void end(const NeighbourhoodUnit&) {}
    // Instead of begin() to end(), for a unit that turns out to have no points.
    virtual void skip(std::size_t /*unit*/) {}
};

struct NeighbourhoodReport {
    Outcome outcome;  // points_in: of the cloud; points_out: the same
    std::uint64_t units = 0;
    std::uint64_t alone = 0;  // points whose neighbours were searched one by one, far beyond their unit
};

// Every point of the cloud belongs to exactly one unit, which is given to one visitor (by one of the processes that
// share them); `make_visitor` is called once
// per thread, on that thread. Units do not depend on the number of threads. The cache gives all chunks; edits that
// visitors make through it do not change positions. Throws Error(invalid_argument) for options out of range,
// Error(unsupported) for a backend that was not built, Error(cancelled), and what reading and the visitors throw.
NeighbourhoodReport for_each_neighbourhood(L2Cache& cache, const NeighbourhoodOptions& options,
                                           const std::function<std::unique_ptr<NeighbourhoodVisitor>()>& make_visitor);

}  // namespace pcm
