// A tree, or a part of it, read like a file.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/io/reader.h"
#include "pcm/tree/selected_nodes.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

// Points come in node order, so those of coarser levels first, with the tree's metadata and exact source coordinates:
// integers on the tree's grid where the source had such and they fit in 32 bits, else doubles. Only the columns that
// are kept or tested are read; nodes outside of box and region are not. Memory: `chunks_ahead` + 1 decoded chunks. One
// thread calls; chunks ahead are read on threads of their own.
class TreeReader final : public PointReader {
public:
    // The cloud at `level` (the whole cloud when absent), of it what `selection` leaves. The number of points is known
    // when all are selected. Throws what Selector throws.
    TreeReader(std::shared_ptr<const Tree> tree, const std::optional<std::uint16_t>& level, const Selection& selection,
               unsigned chunks_ahead = 1);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return !selector_.tests_points(); }
    void seek(std::uint64_t index) override;
    double fraction_read() const override;

    std::uint64_t points_seen() const { return seen_; }  // of the chunks that were looked at, so far

private:
    bool next_chunk();
    Vec3d position(std::size_t i) const;

    std::shared_ptr<const Tree> tree_;
    std::optional<std::uint16_t> level_;
    Selector selector_;
    FileInfo info_;
    ColumnSet columns_;
    bool single_precision_ = false;
    std::size_t chunks_ahead_;

    std::vector<SelectedNode> nodes_;       // with points, in order
    std::vector<std::uint64_t> first_;      // number of points of the nodes before each
    std::size_t next_node_ = 0;             // of those whose chunks were taken
    std::size_t next_ahead_ = 0;            // of those asked for
    std::deque<std::future<Chunk>> ahead_;  // nodes [next_node_, next_ahead_)
    Chunk chunk_;
    bool all_ = true;  // points of the chunk are selected
    std::vector<std::uint32_t> selected_;
    std::size_t next_point_ = 0, chunk_points_ = 0;  // of the selected ones
    std::uint64_t seen_ = 0;
};

}  // namespace pcm
