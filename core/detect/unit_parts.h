// Parts of surfaces in the units of an assignment, and which of them are one.
#pragma once

#include "pcm/detect/assign_points.h"
#include "pcm/detect/border_cells.h"
#include "pcm/system/file.h"

#include <atomic>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

namespace pcm {

// Numbers of parts of all units, each given once: as many as a label has room for in addition to interior_label. Any
// number of threads.
class PartNumbers {
public:
    // `taken`: the first numbers, which are not given.
    explicit PartNumbers(std::uint64_t taken = 0) : next_(taken) {}
    // The first of `count` numbers in sequence, below interior_label - 1. Throws Error(unsupported).
    std::uint32_t take(std::size_t count);

private:
    std::atomic<std::uint64_t> next_;
};

// A part in one unit.
struct UnitPart {
    std::uint32_t number = 0;
    SurfacePart part;
};

using NumberPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Adds a part of the same surface, whose hypothesis becomes that of both; halves the points that are kept where there
// are more than `most_some`.
void add_to(SurfacePart& whole, const SurfacePart& part, std::size_t most_some);

// The parts of all units, in a scratch file without a name: four bytes of each, and the pairs, are in memory
// until together().
class UnitParts {
public:
    // Throws what creating a file throws.
    explicit UnitParts(std::size_t units);
    // Any number of threads, but one by one of the same unit. `joined`: pairs that are one. All are among the parts of
    // some call. Throws Error(no_space | io).
    void add(std::size_t unit, const std::vector<UnitPart>& parts, const NumberPairs& joined);
    // Adds those together that are one, in the order of units: those in pairs, and those of one hypothesis with a cell
    // in common. What has fewer points, or points of the sample, than the minimum is left out. Once, when all are
    // added: 20 bytes per part are in memory, and of those that are returned all. Parts keep about `most_some` points
    // (SurfacePart::some). Throws what reading throws.
    AssignedPoints together(const BorderCells& border, std::uint64_t least_points, std::uint64_t least_sampled,
                            std::size_t most_some = 4096);

private:
    struct Run {  // parts in the file
        std::uint64_t place = 0, bytes = 0;
    };
    struct Unit {
        std::vector<Run> runs;
        NumberPairs joined;
    };
    template <class Use>
    void for_each(const Use& use) const;

    File file_;
    std::mutex mutex_;
    std::uint64_t bytes_ = 0;
    std::vector<Unit> units_;
    std::vector<std::uint32_t> numbers_;
};

}  // namespace pcm
