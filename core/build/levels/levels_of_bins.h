// The levels of the points of bins, as the stage after sampling asks for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

class LevelsOfBins {
public:
    virtual ~LevelsOfBins() = default;
    // Number of points of each level in a bin.
    virtual const std::vector<std::uint64_t>& histogram(std::size_t bin) const = 0;
    // Level of every point of a bin, in its order. Any thread.
    virtual std::vector<std::uint8_t> levels(std::size_t bin) const = 0;
};

}  // namespace pcm
