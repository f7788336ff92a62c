// PointCloud: the one interface for those who use a tree rather than build one.
//
//     auto cloud = pcm::PointCloud::open("city.pct");
//     auto cursor = cloud->points();                       // or points(query)
//     pcm::PointView view;
//     while (cursor.getNextData(view))
//         for (std::size_t i = 0; i < view.size(); ++i) use(view.position(i));
//
// A PointCloud may be shared between threads; a cursor belongs to one thread.
#pragma once

#include "cache/l2_cache.h"
#include "io/selection.h"
#include "tree/tree.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct Query {
    std::optional<Box3d> box;                // source coordinates, both ends included; everything when absent
    std::optional<std::uint16_t> level;      // the cloud at this level; the whole cloud when absent
    std::vector<Condition> where;            // on attributes; all must be met (parse_condition() makes them from text)
    std::vector<std::string> attributes;     // names to read beside the position; unknown names are an error
};

// The points of one chunk that a query selects. Valid until the cursor moves on or dies.
class PointView {
public:
    std::size_t size() const { return selected_ ? selected_->size() : count_; }
    NodeId node() const { return node_; }
    // Source coordinates, double.
    Vec3d position(std::size_t i) const { return grid_->to_source(chunk_->positions->grid(index(i))); }
    Vec3i grid_position(std::size_t i) const { return chunk_->positions->grid(index(i)); }
    // Attribute number `attribute` of the query's list.
    double value(std::size_t i, std::size_t attribute, std::uint32_t component = 0) const
    {
        return chunk_->attributes[(*slots_)[attribute]]->value(index(i), component);
    }
    const Column& column(std::size_t attribute) const { return *chunk_->attributes[(*slots_)[attribute]]; }
    // Position of selected point i in the chunk's columns.
    std::size_t index(std::size_t i) const { return selected_ ? (*selected_)[i] : i; }

private:
    friend class PointCursor;
    NodeId node_ = no_node;
    const Grid* grid_ = nullptr;
    const Chunk* chunk_ = nullptr;
    const std::vector<std::size_t>* slots_ = nullptr;
    std::size_t count_ = 0;
    const std::vector<std::uint32_t>* selected_ = nullptr;
};

class PointCloud;

class PointCursor {
public:
    PointCursor(PointCursor&&) noexcept;
    PointCursor& operator=(PointCursor&&) noexcept;
    ~PointCursor();
    // Moves to the next chunk with selected points; false at the end. Memory: two chunks (the next one is read ahead).
    bool getNextData(PointView& view);

private:
    friend class PointCloud;
    struct State;
    explicit PointCursor(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

class PointCloud : public std::enable_shared_from_this<PointCloud> {
public:
    // Errors: those of Tree::open.
    static std::shared_ptr<PointCloud> open(const std::filesystem::path& path, const L2Options& cache = {});

    const TreeInfo& info() const { return tree_->info(); }
    const std::shared_ptr<const Tree>& tree() const { return tree_; }
    L2Cache& cache() { return *cache_; }

    // Points in node order, streaming, in bounded memory. Throws Error(invalid_argument) for an unknown attribute and what Selector
    // throws.
    PointCursor points(const Query& query = {});

    // Nodes whose boxes a query touches and that have points of its level or stand above such, parents first.
    std::vector<NodeId> nodes_of(const Query& query) const;

private:
    PointCloud() = default;
    std::shared_ptr<const Tree> tree_;
    std::unique_ptr<L2Cache> cache_;
};

}  // namespace pcm
