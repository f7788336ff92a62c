// Positions and values of points that are named: by their node and their number in it, as queries, searches and
// selections name them.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

struct QuerySource;

struct PointName {
    NodeId node = no_node;
    std::uint32_t number = 0;  // PointView::number(), Neighbour::index
};

struct NamedPoints {
    std::vector<Vec3d> positions;  // source coordinates
    std::vector<Column> columns;   // raw values, as the file stores them: a column for each attribute asked for
};

// In the order of the names, which may name a point several times. Each chunk is read once, into the cache. Throws
// Error(invalid_argument) for an unknown attribute and for a point that the cloud does not have, and what reading
// throws.
NamedPoints named_points(QuerySource& source, const std::vector<PointName>& names,
                         const std::vector<std::string>& attributes);

}  // namespace pcm
