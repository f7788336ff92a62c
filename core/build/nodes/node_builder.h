// Builds the nodes of a region, top down and in memory: a node's chunk takes as many levels as fit, and the remaining
// points are cut in two. Points come in Morton order with their levels (level_sampler.h) and keep that order.
//
// Regions larger than memory are built in parts: points of the chunks of nodes above a part are handed up, and those
// nodes are built when all their parts are.
#pragma once

#include "pcm/bpc/chunk_identity.h"
#include "pcm/build/bins/row.h"
#include "pcm/build/levels/lattice.h"
#include "pcm/build/nodes/draft.h"
#include "pcm/tree/chunk_size.h"
#include "pcm/tree/tree.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

struct NodeBuilderOptions {
    Grid grid;
    Lattice lattice;
    Schema schema;
    RowLayout layout;
    std::uint32_t chunk_points = default_chunk_points;
    std::vector<double> spacings;            // spacing of each level
    std::uint32_t part = 0, generation = 1;  // as in ChunkIdentity
};

// Levels first .. last - 1 go into one chunk.
struct LevelRange {
    std::size_t first = 0, last = 0;
    std::size_t size() const { return last - first; }
};

// As many levels from `first` on as together have at most `most` points; all that are left when they fit.
LevelRange levels_that_fit(const std::vector<std::uint64_t>& histogram, std::size_t first, std::uint64_t most);

// Points with their levels and the codes of their sizes (tree/point_size.h), rows one after the other.
struct LeveledRows {
    std::vector<std::byte> rows;
    std::vector<std::uint8_t> levels, sizes;
};

template <class Coord>
class NodeBuilder {
public:
    // The root of a region, and the points that it hands up: above[d] to the node at depth d.
    struct Region {
        Draft* draft = nullptr;  // null when all points of the region went up
        std::vector<LeveledRows> above;
    };

    // Chunks in the order they were finished, and the drafts they belong to.
    struct Output {
        std::vector<std::byte> bytes;
        struct Piece {
            Draft* draft;
            std::size_t from, size;
        };
        std::vector<Piece> pieces;
    };

    NodeBuilder(const NodeBuilderOptions& options, DraftStore& drafts) : options_(options), drafts_(drafts) {}

    // Builds a region of all its points at `path`. `above`: the levels that the nodes above take, one range per depth,
    // consecutive from level 0.
    Region build(const LeveledRows& points, const NodePath& path, const std::vector<LevelRange>& above, Output& output);
    // The same without making any node: what build() of this region hands up.
    Region hand_up(const LeveledRows& points, const std::vector<LevelRange>& above) const;
    // Two regions' handed-up points as those of the region that both are parts of.
    static Region join(Region left, Region right);
    // Two siblings under a new node at `path`, whose chunk takes the levels of `own`.
    Region merge(Region left, Region right, const NodePath& path, const LevelRange& own, Output& output);

private:
    using Indices = std::vector<std::uint32_t>;
    Region divide(const LeveledRows& points, const std::vector<LevelRange>& above, Indices* own) const;
    Indices cut(const LeveledRows& points, Indices& indices) const;
    Draft* build_range(const LeveledRows& points, Indices& indices, std::size_t first, const NodePath& path,
                       Output& output);
    double spacing_after(const LevelRange& own) const;
    static Indices by_level(const LeveledRows& points, const Indices& indices, Draft& draft);
    std::shared_ptr<ChunkPositions> positions_of(const LeveledRows& points, const Indices& order, Draft& draft) const;
    std::vector<std::shared_ptr<Column>> columns_of(const LeveledRows& points, const Indices& order) const;
    // Gives a node its chunk: the points at `indices`, which are in Morton order, by level.
    void emit(const LeveledRows& points, const Indices& indices, Draft& draft, Output& output) const;

    const NodeBuilderOptions& options_;
    DraftStore& drafts_;
};

extern template class NodeBuilder<std::uint32_t>;
extern template class NodeBuilder<std::uint64_t>;

}  // namespace pcm
