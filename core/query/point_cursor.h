// Reading the points of a cloud chunk by chunk: see point_cloud.h.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/query/query.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

struct QuerySource;
struct SelectedChunk;

// The points of one chunk that a query selects. Valid until the cursor moves on or is destroyed.
class PointView {
public:
    std::size_t size() const { return selected_ ? selected_->size() : count_; }
    NodeId node() const { return node_; }
    // Source coordinates, double.
    Vec3d position(std::size_t i) const { return (*rounding_)(grid_->to_source(chunk_->positions->grid(index(i)))); }
    Vec3i grid_position(std::size_t i) const { return chunk_->positions->grid(index(i)); }
    // The raw value, as the file stores it, of attribute number `attribute` of the query's list. The value in the
    // attribute's own unit is raw * Attribute::scale + Attribute::offset (PointCloud::info().schema). A 64-bit integer
    // above 2^53 is rounded to double; column() has it exactly.
    double value(std::size_t i, std::size_t attribute, std::uint32_t component = 0) const
    {
        return chunk_->attributes[(*slots_)[attribute]]->value(index(i), component);
    }
    // All raw values of the attribute that were read; those of selected point i are at index(i).
    const Column& column(std::size_t attribute) const { return *chunk_->attributes[(*slots_)[attribute]]; }
    // Place of selected point i in the columns, which hold the segments of the chunk that were read.
    std::size_t index(std::size_t i) const { return selected_ ? (*selected_)[i] : i; }
    // Number of selected point i in the node's whole chunk. The node and this number identify a point of the tree.
    std::uint32_t number(std::size_t i) const;

private:
    friend class PointCursor;
    NodeId node_ = no_node;
    const Grid* grid_ = nullptr;
    const SourceRounding* rounding_ = nullptr;
    const Chunk* chunk_ = nullptr;
    const SelectedChunk* part_ = nullptr;
    const std::vector<std::size_t>* slots_ = nullptr;
    std::size_t count_ = 0;
    const std::vector<std::uint32_t>* selected_ = nullptr;
};

// What a cursor did so far.
struct CursorStatistics {
    std::uint64_t chunks = 0;         // looked at
    std::uint64_t chunks_cached = 0;  // chunks found in the cache
    std::uint64_t points_read = 0;    // decoded or found in the cache, selected or not
    std::uint64_t bytes_read = 0;     // size of chunks that were read in part, past the cache
};

// The selected points in node order, in bounded memory: Query::reads_in_flight chunks and the one in view. One thread.
// Keeps the open tree and its cache alive.
class PointCursor {
public:
    // PointCloud::points() makes cursors. Throws Error(invalid_argument) for an unknown attribute, and what Selector
    // throws.
    PointCursor(std::shared_ptr<QuerySource> source, const Query& query);
    PointCursor(PointCursor&&) noexcept;
    PointCursor& operator=(PointCursor&&) noexcept;
    ~PointCursor();

    // Moves to the next chunk with selected points; false at the end. A chunk that the query cuts is read in part and
    // not kept in the cache, unless the cache holds it already. Throws what reading throws, and Error(cancelled) when
    // the query's progress function returns false; the cursor may then be dropped, or called again.
    bool getNextData(PointView& view);
    CursorStatistics statistics() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pcm
