// The grid for writing a cloud of doubles as LAS.
#pragma once

#include "pcm/io/reader.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct OutputGrid {
    Grid grid;
    std::uint64_t points_read = 0;   // 0: the points were not needed
    std::vector<std::string> notes;  // when positions are not exact on it
};

// With `scale`: that step, from the offset of the cloud's own grid (or the one it is near) when all points fit 32 bits
// from there, else from a round number near the middle. Without: the grid that the cloud's doubles are near, when all
// are exact on it; else what GridChoice proposes. `progress` gets the fraction of the points read and may throw.
OutputGrid choose_output_grid(PointReader& cloud, const std::optional<Vec3d>& scale,
                              const std::function<void(double)>& progress);

}  // namespace pcm
