// Builds the nodes of a region bottom-up, in memory: k-d cuts down to leaves, then level by level a coarser sample of two
// siblings becomes the parent's candidates, and what was not chosen becomes the siblings' chunks.
//
// Sampling is on a lattice: a candidate is chosen for each cell of the lattice that holds any, the one nearest the cell's
// centre. Cells are prefixes of Morton codes of the grid coordinates, so one lattice serves the whole cloud and its cells
// nest; "lattice level" g means that the codes' lowest g bits are dropped, so cells grow by 2 in volume with each level.
// The lattice level of a node is the finest whose sample fits the node's share of points. Every choice depends on the set
// of points alone, not on the order they come in.
#pragma once

#include "bpc/bpc.h"
#include "tree/cut.h"
#include "tree/row.h"
#include "tree/tree.h"

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

namespace pcm {

// A node in the making.
struct Draft {
    std::array<Draft*, 2> children{nullptr, nullptr};
    NodePath path;
    Box3i box;  // of its own points
    std::uint32_t points = 0;
    double spacing = 0;
    Extent extent;  // of its chunk; file and offset are known once the chunk is written
};

// Owns drafts; they never move. add() may be called from any thread.
class DraftStore {
public:
    Draft* add(const NodePath& path)
    {
        const std::lock_guard lock(mutex_);
        drafts_.emplace_back();
        drafts_.back().path = path;
        return &drafts_.back();
    }

private:
    std::mutex mutex_;
    std::deque<Draft> drafts_;
};

struct NodeBuilderOptions {
    Grid grid;
    Schema schema;
    RowLayout layout;
    AxisShift finer{0, 0, 0};
    std::uint32_t chunk_points = 100000;
};

template <class Coord>
class NodeBuilder {
public:
    struct Key {
        std::array<Coord, 3> c;
        std::uint32_t row;
    };
    using Rows = std::shared_ptr<const std::vector<std::byte>>;

    // A region whose nodes are made but for the chunk of its root, which depends on what the parent chooses.
    struct Region {
        std::vector<Key> candidates;  // every point that has no chunk yet
        Rows rows;                    // the candidates' rows
        int lattice_level = -1;       // -1: all points of the region are candidates
        Draft* draft = nullptr;       // its root
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

    // All points of `rows`.
    Region build(std::vector<std::byte> rows, const NodePath& path, Output& output);
    // Two siblings under a new node at `path`.
    Region merge(Region left, Region right, const NodePath& path, Output& output);
    // Gives the root of the whole cloud its chunk.
    void finish(Region root, Output& output);
    // Copies the candidates' rows, so that the rows of a whole bin need not be kept.
    void compact(Region& region) const;

private:
    struct Order;  // candidates in Morton order
    Region build_range(Key* keys, std::size_t count, const Rows& rows, const NodePath& path, Output& output);
    Order morton_order(const std::vector<Key>& keys, const std::vector<const std::byte*>& row_of) const;
    void emit(const std::vector<Key>& keys, const std::byte* rows, Draft& draft, Output& output);

    const NodeBuilderOptions& options_;
    DraftStore& drafts_;
};

extern template class NodeBuilder<std::uint32_t>;
extern template class NodeBuilder<std::uint64_t>;

}  // namespace pcm
