// The points of a tree, of all its levels and parts, in boxes of grid positions.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/tree/tree.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace pcm {

// Some points of a chunk, or of those segments of it that were read.
struct PointsInBox {
    Chunk chunk;
    bool all = true;                     // all points of `chunk`; else those in `indices`
    std::vector<std::uint32_t> indices;  // ascending

    std::size_t size() const { return all ? chunk.points : indices.size(); }
    std::size_t index(std::size_t i) const { return all ? i : indices[i]; }
};

// Any number of threads.
class PointsInBoxes {
public:
    explicit PointsInBoxes(std::shared_ptr<const Tree> tree) : tree_(std::move(tree)), rounding_(tree_->info()) {}

    // The nodes with points that can have some in `box`, parents first.
    std::vector<NodeId> nodes(const Box3i& box) const;
    // The points of a node in `box`, both ends included. Throws what reading throws.
    PointsInBox read(NodeId node, const Box3i& box, const ColumnSet& columns) const;
    // Calls take() for the points of each chunk that has some in `box`, both ends included, until it returns false.
    // Memory: one chunk. Throws what reading throws.
    void visit(const Box3i& box, const ColumnSet& columns, const std::function<bool(PointsInBox&)>& take) const;

    const Tree& tree() const { return *tree_; }
    // Source coordinates as readers of the tree return them.
    double source(std::int64_t q, std::size_t axis) const
    {
        return rounding_(tree_->info().grid.to_source(q, axis), axis);
    }
    // Adds the source coordinates of the points.
    void append(const PointsInBox& points, std::array<std::vector<double>, 3>& to) const;

private:
    const std::shared_ptr<const Tree> tree_;
    const SourceRounding rounding_;
};

}  // namespace pcm
