// Reads a tree, or a selection of its points, like a file.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/io/reader.h"
#include "pcm/threads/task_pool.h"
#include "pcm/tree/selected_nodes.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

// Which points of a tree are wanted, one by one. Any number of threads.
class PointChoice {
public:
    virtual ~PointChoice() = default;
    virtual std::uint32_t count(NodeId node) const = 0;
    // The numbers of the node's points that are wanted, ascending: count() of them.
    virtual std::vector<std::uint32_t> points(NodeId node) const = 0;
};

// Points come in node order, so coarser levels come first, with the tree's metadata and exact source coordinates:
// integers on the tree's grid where the source had integers and they fit in 32 bits, else doubles. Only the columns
// that are kept or tested are read; nodes outside of box and region are not read. Memory: `chunks_ahead` + 1 decoded
// chunks. One thread calls; `chunks_ahead` threads of the reader's own read ahead.
class TreeReader final : public PointReader {
public:
    // The selected points of the cloud at `level` (of the whole cloud when absent). The number of points is known in
    // advance when the selection chooses no points. Throws what Selector throws.
    TreeReader(std::shared_ptr<const Tree> tree, const std::optional<std::uint16_t>& level, const Selection& selection,
               unsigned chunks_ahead = 1);

    // The points of a choice. Their number is known; chunks without any are not read.
    TreeReader(std::shared_ptr<const Tree> tree, std::shared_ptr<const PointChoice> choice, unsigned chunks_ahead = 1);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return !selector_.tests_points() && !choice_; }
    void seek(std::uint64_t index) override;
    double fraction_read() const override;

    const Tree& tree() const { return *tree_; }
    // The nodes whose points are read, in order. From now on those of a range alone are, from its beginning.
    const std::vector<SelectedNode>& nodes() const { return nodes_; }
    void keep_nodes(std::size_t first, std::size_t end);

private:
    TreeReader(std::shared_ptr<const Tree> tree, const std::optional<std::uint16_t>& level, const Selection& selection,
               std::shared_ptr<const PointChoice> choice, unsigned chunks_ahead);
    bool next_chunk();
    void choose(const SelectedNode& node);
    Vec3d position(std::size_t i) const;

    std::shared_ptr<const Tree> tree_;
    std::optional<std::uint16_t> level_;
    Selector selector_;
    std::shared_ptr<const PointChoice> choice_;  // null: all that the selector chooses
    const SourceRounding rounding_;
    FileInfo info_;
    ColumnSet columns_;
    std::size_t chunks_ahead_;

    std::vector<SelectedNode> nodes_;   // with points, in order
    std::vector<std::uint64_t> first_;  // number of points of the nodes before each
    std::size_t next_node_ = 0;         // the next node whose chunk is taken
    std::size_t next_ahead_ = 0;        // the next node whose chunk is requested
    std::size_t end_node_ = 0;          // the node after the last one that is read
    TaskPool pool_;
    std::deque<Pending<Chunk>> ahead_;  // nodes [next_node_, next_ahead_)
    Chunk chunk_;
    bool all_ = true;  // all points of the chunk are selected
    std::vector<std::uint32_t> selected_;
    std::size_t next_point_ = 0, chunk_points_ = 0;  // positions in selected_
};

}  // namespace pcm
