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
    std::uint64_t points_read = 0;   // 0: they were not needed
    std::vector<std::string> notes;  // for positions that are not exact on it
};

// With `scale`, a grid of that step. Its offset is that of the cloud's own grid (or of FileInfo::near_grid) when all
// points then fit 32 bits, else a round number near the middle. Without `scale`: FileInfo::near_grid when all points
// are exact on it, else what GridChoice proposes. `progress` gets the fraction of the points read and may throw. Throws
// Error(invalid_argument) when some points are so far away that the others would be rounded onto each other
// (io/pipe/far_points.h).
OutputGrid choose_output_grid(PointReader& cloud, const std::optional<Vec3d>& scale,
                              const std::function<void(double)>& progress);

}  // namespace pcm
