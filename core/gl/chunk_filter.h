// Which points of a cloud's chunks are shown: those that meet the conditions of a style. No OpenGL here.
#pragma once

#include "pcm/bpc/chunk.h"
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
    ChunkFilter(const std::vector<Condition>& where, const Schema& schema);

    // Why conditions were left out; empty if none was.
    const std::string& notice() const { return notice_; }
    // The columns that the conditions test.
    const ColumnSet& tested() const { return tested_; }
    // The chunk without the points that do not meet the conditions; its columns are those of `needed`. `chunk` has
    // these and the tested ones.
    Chunk apply(const Chunk& chunk, const Grid& grid, const ColumnSet& needed) const;

private:
    std::optional<Selector> selector_;
    ColumnSet tested_;
    std::string notice_;
};

}  // namespace pcm
