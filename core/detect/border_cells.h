// Where parts of neighbouring units of a detection meet.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

namespace pcm {

// Labels that stand for the same. The result does not depend on the order of calls.
class JoinedLabels {
public:
    explicit JoinedLabels(std::size_t count);
    void join(std::uint32_t a, std::uint32_t b);
    std::uint32_t root(std::uint32_t label);  // the least of those that are the same

private:
    std::vector<std::uint32_t> parent_;
};

// A cell of a unit's sample at its border, and what its point belongs to.
struct BorderCell {
    std::uint64_t key = 0;  // below 2^63, evenly distributed
    std::uint32_t hypothesis = 0, label = 0;
};

// Cells of all units, in a scratch file without a name. Any number of threads may add.
class BorderCells {
public:
    BorderCells();                                   // throws what creating a file throws
    void add(const std::vector<BorderCell>& cells);  // throws Error(no_space | io)
    // Calls join(a, b) for labels of one hypothesis that have a cell in common. Reads the file once for each `most`
    // cells that it has: this number, or a little more, are in memory at once.
    void join(const std::function<void(std::uint32_t, std::uint32_t)>& join, std::size_t most) const;

private:
    File file_;
    std::mutex mutex_;
    std::uint64_t cells_ = 0;
};

}  // namespace pcm
