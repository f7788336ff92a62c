// Keeps a pass over units to a time limit: units that are still to come are computed at a coarser level when time gets
// short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

namespace pcm {

// Any number of threads.
class LevelClock {
public:
    // costs[l]: cost of a unit computed at level l, in any unit, positive, not decreasing; the last is that of all
    // points. `level`: the one to begin with, below costs.size(). `seconds`: time limit of the pass.
    LevelClock(std::vector<double> costs, std::size_t level, double seconds);

    // The level of the next unit, when `passed` seconds have passed since the pass began, and a share (0 to 1) of the
    // units is done: the finest one, not finer than the first, at which the rest is done in time at the speed so far;
    // 0 where none is. `units`: number of units of the pass.
    std::size_t next(double passed, double share, std::size_t units);

    // The units that were given a level: how many, how many another one than the first, and the coarsest level.
    std::size_t units() const;
    std::size_t coarser_units() const;
    std::size_t coarsest() const;

private:
    const std::vector<double> costs_;
    const std::size_t first_;
    const double seconds_;
    mutable std::mutex mutex_;
    double begun_ = 0;  // cost of the units that were given a level
    std::size_t given_ = 0, coarser_ = 0, coarsest_;
};

}  // namespace pcm
