// Changing points of a cloud: see point_cloud.h.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/query/query.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

class PointCloud;

// The points of one chunk that a query selects, to be changed. Valid until the cursor moves on or dies. What was
// changed counts once it is marked; a cursor that is to move on from changes that are not throws.
class EditView {
public:
    std::size_t size() const { return numbers_->size(); }
    NodeId node() const { return node_; }
    // Source coordinates, double.
    Vec3d position(std::size_t i) const { return grid_->to_source(edit_->chunk().positions->grid((*numbers_)[i])); }
    // Attribute number `attribute` of the query's list, raw, with what was set.
    double value(std::size_t i, std::size_t attribute, std::uint32_t component = 0) const;
    // Throws Error(invalid_argument) for a value that the attribute's type cannot have: a fraction for an integer, one
    // out of range.
    void set(std::size_t i, std::size_t attribute, double value, std::uint32_t component = 0);
    // All points of the chunk, selected or not, to be changed; selected point i is number index(i) there.
    Column& column(std::size_t attribute);
    std::uint32_t index(std::size_t i) const { return (*numbers_)[i]; }
    const Chunk& chunk() const { return edit_->chunk(); }
    void mark_written() { edit_->mark_written(); }

private:
    friend class EditCursor;
    NodeId node_ = no_node;
    const Grid* grid_ = nullptr;
    L2Cache::Edit* edit_ = nullptr;
    const std::vector<std::uint32_t>* numbers_ = nullptr;
    const std::vector<std::size_t>* slots_ = nullptr;
    std::vector<Column*> columns_;  // that are in change, by the query's attributes
};

class EditCursor {
public:
    EditCursor(EditCursor&&) noexcept;
    EditCursor& operator=(EditCursor&&) noexcept;
    ~EditCursor();
    // Moves to the next chunk with selected points; false at the end. Throws what reading throws,
    // Error(invalid_argument) when the last view was changed and not marked as written (the change is dropped) and when
    // the cloud was closed, and Error(cancelled) when the query's progress function says so.
    bool getNextData(EditView& view);

private:
    friend class PointCloud;
    EditCursor(std::shared_ptr<PointCloud> cloud, const Query& query);
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pcm
