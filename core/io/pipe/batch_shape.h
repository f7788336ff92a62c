// How readers prepare a batch that callers pass to them repeatedly.
#pragma once

#include "pcm/cloud/point_batch.h"

#include <algorithm>
#include <cstddef>

namespace pcm {

// Records may have tens of kilobytes; a batch stays below this many bytes however many points are requested.
inline constexpr std::size_t max_batch_bytes = std::size_t{64} << 20;

inline std::size_t points_that_fit_a_batch(const Schema& schema)
{
    constexpr std::size_t position_bytes = 3 * sizeof(double);
    return std::max<std::size_t>(1, max_batch_bytes / (position_bytes + schema.point_bytes()));
}

// As PointBatch::reset, but keeps the memory of a batch that already has the right shape.
inline void shape_batch(PointBatch& batch, const Schema& schema, bool gridded, std::size_t points)
{
    bool same = batch.gridded == gridded && batch.attributes.size() == schema.size();
    for (std::size_t i = 0; same && i < schema.size(); ++i)
        same = batch.attributes[i].type() == schema[i].type && batch.attributes[i].components() == schema[i].components;
    if (same)
        batch.resize(points);
    else
        batch.reset(schema, gridded, points);
}

}  // namespace pcm
