// Finds the neighbourhoods of one unit after the other.
#pragma once

#include "pcm/knn/neighbourhoods.h"
#include "pcm/knn/point_search.h"
#include "pcm/knn/unit_points.h"
#include "pcm/threads/crew.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// The neighbours of a unit's points are searched among the points that were loaded: the unit's and those within a
// margin around it. Where points that were not loaded may be nearer than the last neighbour found, the margin is made
// larger, as long as that loads few points; what remains is searched point by point in the whole tree.
//
// For one thread; all arguments outlive it.
class UnitWorker {
public:
    UnitWorker(L2Cache& cache, BlockCache& blocks, const NeighbourhoodOptions& options, const Signal& signal,
               NeighbourhoodVisitor& visitor);
    // Returns whether the unit has points. Throws what reading and the visitor throw, and Error(cancelled) once the
    // signal is stopped.
    bool run(std::size_t number, const Box3i& box);
    std::uint64_t computed() const { return computed_; }
    std::uint64_t alone() const { return alone_; }  // points that were searched one by one

private:
    void search_together();
    void search(const std::vector<std::uint32_t>* points);
    void take(const FoundNeighbours& found);
    double needed(const FoundNeighbours& found, std::size_t i) const;
    bool widen();
    void search_alone(std::uint32_t number);
    void begin_block(std::size_t stride, std::size_t points);
    void add_point(std::uint32_t number, std::size_t count);
    void hand_over();
    double first_margin(const Box3i& box);
    void learn_margin();

    L2Cache& cache_;
    const NeighbourhoodOptions& options_;
    const Signal& signal_;
    NeighbourhoodVisitor& visitor_;
    const double rounding_;  // rounding of source coordinates, source units
    PointSearch search_alone_;
    const Box3i cloud_;

    std::optional<double> margin_;  // margin of the next unit
    GatheredPoints points_;
    NeighbourhoodUnit unit_;
    std::vector<std::pair<double, std::uint32_t>> unresolved_;  // margin that they need, number
    std::vector<double> distances_;                             // to the last neighbours, of some points
    Neighbourhoods block_;
    std::vector<Neighbour> found_;
    std::uint64_t computed_ = 0, alone_ = 0, seen_ = 0;
};

}  // namespace pcm
