// Makes the vertices of a cloud's chunks: conditions and clips, shapes, radii, colours, the selected points. No OpenGL
// here.
//
// It shares all that it reads but for the chunks, and does not change: loader threads make vertices with it while the
// GL thread already has another one, for another style.
#pragma once

#include "pcm/gl/draw/cloud_facts.h"
#include "pcm/gl/l1/chunk_filter.h"
#include "pcm/gl/l1/chunk_vertices.h"
#include "pcm/query/point_set.h"
#include "pcm/tree/tree.h"
#include "pcm/view/point_colours.h"
#include "pcm/view/point_sizes.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

// What vertices are made by, in addition to the chunk.
struct VertexRecipe {
    std::shared_ptr<const Tree> tree;
    VertexFormat format;
    std::optional<AttributePlace> colour;       // attribute of the colours, if the format has some
    ColourScale scale;                          // scale of colours by RGB
    ValueRange range;                           // range of colours by value
    std::shared_ptr<const ChunkFilter> filter;  // null: all points have vertices
    std::shared_ptr<const PointSet> selected;   // null: none is
    std::shared_ptr<const PointSizes> sizes;    // for a format with radii
    bool operator==(const VertexRecipe& o) const
    {
        return tree == o.tree && format == o.format && colour == o.colour && scale.low == o.scale.low &&
               scale.high == o.scale.high && range.low == o.range.low && range.high == o.range.high &&
               filter == o.filter && selected == o.selected;
    }
};

struct MadeVertices {
    ChunkVertices vertices;
    ClassSet classes;  // classes that occur, for colours by class
};

// 0: no point of the node is selected, else a number made from those that are: vertices of a node whose selected points
// are the same as before need not be made again.
std::uint64_t selection_number(const PointSet& selected, NodeId node);

class VertexMaker {
public:
    explicit VertexMaker(VertexRecipe recipe);

    const VertexRecipe& recipe() const { return recipe_; }
    // The columns that make() reads.
    ColumnSet columns() const;
    // `chunk` has at least these columns. Any thread.
    MadeVertices make(NodeId node, const Chunk& chunk) const;

private:
    // Values of a chunk's vertices, while these are made.
    struct Values;
    ColumnSet columns_kept() const;  // columns that become attributes of vertices
    void find_shapes_of(NodeId node, const Chunk& whole, const std::vector<std::uint32_t>* points,
                        Values& values) const;
    void use_own_normals(const Chunk& chunk, Values& values) const;
    void find_colours(const Chunk& chunk, Values& values) const;
    void find_attributes(NodeId node, const Chunk& chunk, Values& values) const;
    void find_flags(NodeId node, const std::vector<std::uint32_t>* points, Values& values) const;

    const VertexRecipe recipe_;
};

}  // namespace pcm
