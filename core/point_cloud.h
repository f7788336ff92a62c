// PointCloud: the one interface for those who use a tree rather than build one.
//
//     auto cloud = pcm::PointCloud::open("city.pct");
//     auto cursor = cloud->points();                       // or points(query)
//     pcm::PointView view;
//     while (cursor.getNextData(view))
//         for (std::size_t i = 0; i < view.size(); ++i) use(view.position(i));
//     cloud->nearest({500123.4, 4800567.8, 120}, 8);       // points
//
// And to change what points have beside their positions, however large the cloud is:
//
//     auto cloud = pcm::PointCloud::open("city.pct", {}, pcm::Access::write);
//     cloud->add_attribute({"height", pcm::ScalarType::f32});
//     auto cursor = cloud->edit(query);                    // query.attributes names what is read or set
//     pcm::EditView view;
//     while (cursor.getNextData(view)) {
//         for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, view.position(i)[2] - 92);
//         view.mark_written();
//     }
//     cloud->close();                                      // all of it is in the tree now; before this, nothing
//
// A PointCloud may be shared between threads; a cursor belongs to one thread.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/affine.h"
#include "pcm/cloud/selection.h"
#include "pcm/edit_cursor.h"
#include "pcm/query/estimate.h"
#include "pcm/query/nearest.h"
#include "pcm/query/point_blocks.h"
#include "pcm/query/query.h"
#include "pcm/query/read_rates.h"
#include "pcm/threads/task_pool.h"
#include "pcm/tree/tree.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct SelectedChunk;

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
    // Position of selected point i in the columns, which hold those segments of the chunk that were read.
    std::size_t index(std::size_t i) const { return selected_ ? (*selected_)[i] : i; }
    // Number of selected point i in the node's whole chunk: with the node, which point of the tree it is.
    std::uint32_t number(std::size_t i) const;

private:
    friend class PointCursor;
    NodeId node_ = no_node;
    const Grid* grid_ = nullptr;
    const Chunk* chunk_ = nullptr;
    const SelectedChunk* part_ = nullptr;
    const std::vector<std::size_t>* slots_ = nullptr;
    std::size_t count_ = 0;
    const std::vector<std::uint32_t>* selected_ = nullptr;
};

class PointCloud;

// What a cursor did so far.
struct CursorStatistics {
    std::uint64_t chunks = 0;         // looked at
    std::uint64_t chunks_cached = 0;  // of them found in the cache
    std::uint64_t points_read = 0;    // decoded or found in the cache, selected or not
    std::uint64_t bytes_read = 0;     // of chunks that were read in part, past the cache
};

class PointCursor {
public:
    PointCursor(PointCursor&&) noexcept;
    PointCursor& operator=(PointCursor&&) noexcept;
    ~PointCursor();
    // Moves to the next chunk with selected points; false at the end. Memory: Query::reads_in_flight chunks and the one
    // in view. Chunks that the query cuts are read in part and not kept in the cache, unless they are there. Throws
    // what reading throws, and Error(cancelled) when the query's progress function says so; the cursor may then be
    // dropped, or asked again.
    bool getNextData(PointView& view);
    CursorStatistics statistics() const;

private:
    friend class PointCloud;
    struct State;
    explicit PointCursor(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

enum class Access : std::uint8_t {
    read,
    write,  // the tree is locked against others who want to change it, not against readers
};

class TreeChanges;

class PointCloud : public std::enable_shared_from_this<PointCloud> {
public:
    // Errors: those of Tree::open; with Access::write also Error(exists) when somebody else changes the tree.
    static std::shared_ptr<PointCloud> open(const std::filesystem::path& path, const L2Options& cache = {},
                                            Access access = Access::read);
    // A new tree of all points of a reader, opened. Errors: those of build_tree() (build/builder.h).
    static std::shared_ptr<PointCloud> create(const std::filesystem::path& path, PointReader& points,
                                              const BuildOptions& build = {}, const L2Options& cache = {},
                                              Access access = Access::write);
    // As close(), but who wants to hear of errors calls that.
    ~PointCloud();

    // With the attributes that were added; `info` and references to it live as long as the cloud.
    const TreeInfo& info() const { return cache_->tree().info(); }
    // As it is on disk since the last flush(), and with the attributes that were added.
    std::shared_ptr<const Tree> tree() const { return store_->tree(); }
    L2Cache& cache() { return *cache_; }

    // Points in node order, streaming, in bounded memory. Throws Error(invalid_argument) for an unknown attribute and
    // what Selector throws.
    PointCursor points(const Query& query = {});

    // What points(query) will find and cost. Throws what points() throws.
    Estimate estimate(const Query& query, EstimatePrecision precision = EstimatePrecision::index);

    // The k points nearest to a point, or to each of many, at a precision; see query/nearest.h.
    NearestResult nearest(const Vec3d& point, std::size_t k, const NearestOptions& options = {});
    NearestBatch nearest(const std::vector<Vec3d>& points, std::size_t k, const NearestOptions& options = {});
    // The point inside of a Region::ray() or Region::cone() that is nearest along it: what a click on the screen picks.
    HitResult first_hit(const Region& beam, const std::optional<std::uint16_t>& level = {});

    // The selected points chunk by chunk, to be changed. Throws what points() throws, and Error(invalid_argument) when
    // the cloud was opened for reading.
    EditCursor edit(const Query& query);
    // A new attribute at the end of the schema; all its values are zero. Returns its place there. It is part of the
    // tree on disk from the next flush() on. Throws Error(invalid_argument) for a name that is there or not possible,
    // and when the cloud was opened for reading.
    std::size_t add_attribute(const Attribute& attribute);
    // What was changed becomes part of the tree on disk, all at one instant. Throws Error(no_space | io | ...); all is
    // still there then, to be flushed again. Throws Error(invalid_argument) when points were changed and not marked as
    // written.
    void flush();
    // flush(), and the lock is let go. Whatever is asked of the cloud and its cursors afterwards is
    // Error(invalid_argument).
    void close();
    // close() without flush(): what was changed since the last one is dropped.
    void abandon();
    // The cloud as a tree of another name, in moments (update/clone.h); what was changed is flushed first.
    void save(const std::filesystem::path& path);

    // The cloud moved, turned or scaled, as a new tree, opened for reading; what was changed is flushed first. Where
    // the map only stretches and shifts along the axes, positions stay what they are on a grid that is mapped; else
    // they are rounded by less than their own last bit. What happens to attributes is in io/pipe/transformed_reader.h.
    // Errors: those of build_tree(), and Error(invalid_argument) for a map that flattens space.
    std::shared_ptr<PointCloud> transform(const Affine& map, const std::filesystem::path& path,
                                          const BuildOptions& build = {}, const L2Options& cache = {});

    // Nodes with points that a query may select, parents first.
    std::vector<NodeId> nodes_of(const Query& query) const;

private:
    PointCloud() = default;
    TreeChanges& changes() const;
    ColumnSet columns_of(const Query& query, const Selector& selector, std::vector<std::size_t>& places) const;
    std::filesystem::path folder_;
    std::shared_ptr<ChunkStore> store_;
    std::shared_ptr<TreeChanges> changes_;  // the store, of a cloud that is open for writing
    std::mutex changes_mutex_;              // of add_attribute() and closing
    std::unique_ptr<L2Cache> cache_;
    ReadRates rates_;
    BlockCache blocks_;
    TaskPool pool_;  // its threads use all of the above
    friend class PointCursor;
};

}  // namespace pcm
