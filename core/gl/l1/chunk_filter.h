// Which points of a cloud's chunks are shown: those that meet the conditions of a style and that clips leave. No OpenGL
// here.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/clip.h"
#include "pcm/cloud/condition.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/selection.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Immutable.
class ChunkFilter {
public:
    // Conditions on attributes that the schema lacks, or on one of several components without its number, are left out.
    ChunkFilter(const std::vector<Condition>& where, const std::vector<Clip>& clips, const Schema& schema);

    // Why conditions were left out; empty if none was.
    const std::string& notice() const { return notice_; }
    // The columns that the conditions test.
    const ColumnSet& tested() const { return tested_; }
    // The numbers of the points that are shown, ascending; absent if all are. `chunk` has the tested columns.
    std::optional<std::vector<std::uint32_t>> shown(const Chunk& chunk, const Grid& grid) const;
    // The chunk with only these points; its columns are those of `needed`, which `chunk` has.
    static Chunk take(const Chunk& chunk, const std::vector<std::uint32_t>& points, const ColumnSet& needed);

private:
    std::optional<Selector> selector_;
    ColumnSet tested_;
    std::string notice_;
};

}  // namespace pcm
