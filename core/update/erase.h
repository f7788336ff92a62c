// Deletes points from a tree.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/selection.h"
#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace pcm {

// Which points of a tree are to be deleted, decided chunk by chunk. Any number of threads may call.
class ChunkTest {
public:
    virtual ~ChunkTest() = default;
    // What chosen() reads of a chunk; the positions are always among them.
    virtual ColumnSet columns() const { return ColumnSet::only_positions(); }
    // Whether the node's subtree may have points to delete; the chunks of others are not read.
    virtual bool touches(NodeId, const Node&) const { return true; }
    // The points of a node's chunk that are to be deleted, by index, ascending.
    virtual std::vector<std::uint32_t> chosen(NodeId node, const Chunk& chunk) const = 0;
};

// Makes the test for the tree, as it is opened by erase_points().
using MakeChunkTest = std::function<std::unique_ptr<ChunkTest>(const std::shared_ptr<const Tree>& tree)>;

struct EraseOptions {
    unsigned threads = 0;     // 0: one per processor
    bool count_only = false;  // changes nothing; the report describes what would be deleted
    ProgressFunction progress;
    double begin = 0;  // start of the range of the progress
};

struct EraseReport {
    Outcome outcome;  // in: the tree's points before; out: after
    std::uint64_t points_deleted = 0;
    std::uint64_t nodes_rewritten = 0, nodes_emptied = 0;
    std::uint64_t bytes_written = 0;
    bool coverage_kept = true;  // the levels' guarantee still holds: only points of the last level were deleted
};

// Deletes the points that `selection` chooses, in place and atomically. Nodes outside of the selection's bounds are not
// read. Nodes that lose points are written again to new data files; compact_tree() frees their old bytes. The remaining
// points keep their levels: no two points of a level are nearer than its spacing, but gaps of a level stay until the
// tree is compacted. A tree that loses all its points becomes an empty tree. Open readers keep reading the old tree (a
// snapshot). Throws Error(invalid_argument) when the selection chooses no points or names an attribute that the tree
// lacks, Error(exists) when another process or thread changes the tree, and what reading and writing throw. After an
// error the tree is the old one; what fails after the points are deleted is a warning of the outcome.
EraseReport erase_points(const std::filesystem::path& tree, const Selection& selection,
                         const EraseOptions& options = {});

// The same for points chosen by a test of each chunk. `make_test` is called when the tree is locked against other
// writers, unless points are only counted; what it throws is thrown.
EraseReport erase_points(const std::filesystem::path& tree, const MakeChunkTest& make_test,
                         const EraseOptions& options = {});

}  // namespace pcm
