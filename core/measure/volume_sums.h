// From the heights in the cells of a grid to volumes and their uncertainty (volume.h says what is summed).
#pragma once

#include "pcm/measure/cell_grid.h"
#include "pcm/measure/height_cells.h"
#include "pcm/measure/volume.h"

#include <functional>
#include <vector>

namespace pcm {

// `cells`: one set for each cloud, the cloud before second; heights relative to the reference. Sets the sums,
// areas and uncertainties of the report. `check`: see fill_gaps(). Any thread.
void add_volumes(VolumeReport& report, const CellGrid& grid, const std::vector<std::vector<HeightCell>>& cells,
                 CellHeight height, EmptyCells empty, const std::function<void()>& check = {});

}  // namespace pcm
