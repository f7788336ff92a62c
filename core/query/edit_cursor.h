// Changing the attributes of points chunk by chunk: see point_cloud.h.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/query/query.h"
#include "pcm/tree/source_rounding.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

struct QuerySource;

// The points of one chunk that a query selects, to be changed. Valid until the cursor moves on or is destroyed. Changes
// count once they are marked as written; a cursor that is to move on from unmarked changes throws.
class EditView {
public:
    std::size_t size() const { return numbers_->size(); }
    NodeId node() const { return node_; }
    // Source coordinates, double.
    Vec3d position(std::size_t i) const
    {
        return (*rounding_)(grid_->to_source(edit_->chunk().positions->grid((*numbers_)[i])));
    }
    // The raw value, as the file stores it, of attribute number `attribute` of the query's list, with what was set. The
    // value in the attribute's own unit is raw * Attribute::scale + Attribute::offset.
    double value(std::size_t i, std::size_t attribute, std::uint32_t component = 0) const;
    // Sets the raw value: of an attribute with a scale or an offset, the caller divides them out first. Throws
    // Error(invalid_argument) for a value that the attribute's type cannot hold: a fraction for an integer type, or one
    // out of its range.
    void set(std::size_t i, std::size_t attribute, double value, std::uint32_t component = 0);
    // Raw values of all points of the chunk, selected or not, to be changed; selected point i is number index(i) there.
    Column& column(std::size_t attribute);
    std::uint32_t index(std::size_t i) const { return (*numbers_)[i]; }
    const Chunk& chunk() const { return edit_->chunk(); }
    void mark_written() { edit_->mark_written(); }

private:
    friend class EditCursor;
    NodeId node_ = no_node;
    const Grid* grid_ = nullptr;
    const SourceRounding* rounding_ = nullptr;
    L2Cache::Edit* edit_ = nullptr;
    const std::vector<std::uint32_t>* numbers_ = nullptr;
    const std::vector<std::size_t>* slots_ = nullptr;
    std::vector<Column*> columns_;  // changed since the last mark, by the query's attributes; null for the others
};

// One thread. Keeps the open tree and its cache alive.
class EditCursor {
public:
    // PointCloud::edit() makes cursors. Throws what PointCursor throws.
    EditCursor(std::shared_ptr<QuerySource> source, const Query& query);
    EditCursor(EditCursor&&) noexcept;
    EditCursor& operator=(EditCursor&&) noexcept;
    ~EditCursor();

    // Moves to the next chunk with selected points; false at the end. Throws what reading throws,
    // Error(invalid_argument) when the last view was changed and not marked as written (the change is dropped) and when
    // the cloud was closed, and Error(cancelled) when the query's progress function returns false.
    bool getNextData(EditView& view);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pcm
