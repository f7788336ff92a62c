// Makes sets of a tree's points: by place and attributes, and by a brush.
//
// Read from the tree on disk, past any cache; a node that lies wholly inside is not read where no attribute is tested.
// Positions are the source coordinates that readers of the tree get. Memory: the set's bits, and a chunk per thread.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

struct SelectOptions {
    std::optional<std::uint16_t> level;  // only points of the cloud at this level; the whole cloud when absent
    unsigned threads = 0;                // 0: one per processor
    ProgressFunction progress;
};

// The points that the selection chooses; all points if it chooses none. Throws what Selector throws, Error(cancelled),
// and what reading throws.
PointSet select_points(const std::shared_ptr<const Tree>& tree, const Selection& selection,
                       const SelectOptions& options = {});

// The points within `radius` of a stroke, the line through `stroke` (of one point: a sphere), of those that `limit`
// chooses. The distance is that of doubles relative to a corner of the stroke, inclusive. Throws
// Error(invalid_argument) for a stroke without points, numbers that are not finite and a negative radius; and what
// select_points() throws.
PointSet brush_points(const std::shared_ptr<const Tree>& tree, const std::vector<Vec3d>& stroke, double radius,
                      const Selection& limit = {}, const SelectOptions& options = {});

}  // namespace pcm
