// A point cloud tree, opened for reading: the node vector in memory, the chunks on disk.
//
// A tree folder (by convention NAME.pct) holds `index.pct` and a few data files; see bpc/FORMAT.md. The tree is a k-d
// tree with one chunk a node. Every point belongs to one level, and levels are additive: the points of level 0..L are
// the cloud at level L, and all levels together hold every point exactly once. A node's chunk has the points of some
// consecutive levels in the node's region, coarse ones first; below it are the finer ones. Nodes are stored parents
// first (node 0 is the root, and a node's number is larger than its parent's), so one forward pass over nodes() visits
// parents before children.
//
// A tree consists of parts: part 0 is what the build made, and every append adds a subtree of its own. The nodes that
// join the parts' roots have no points. Parts may overlap in space; levels 0..L of all parts together are the sample at
// level L.
//
// A Tree is immutable after open(); every member may be called from any number of threads.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/bpc/chunk_identity.h"
#include "pcm/bpc/commit_record.h"
#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/io/reader.h"
#include "pcm/system/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct BpcHeader;
class DataFilePool;

using NodeId = std::uint32_t;
inline constexpr NodeId no_node = 0xffffffffu;
inline constexpr std::uint32_t no_part = 0xffffffffu;

// Where a chunk lies: `bytes` bytes at `offset` of data file number `file`. bytes == 0 for a node without points.
struct Extent {
    std::uint32_t file = 0;
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
    std::uint32_t header_bytes = 0;  // how many of them are the chunk's header
    bool operator==(const Extent& o) const
    {
        return file == o.file && offset == o.offset && bytes == o.bytes && header_bytes == o.header_bytes;
    }
};

// Each update writes new data files; a file of which nothing is in use any more may be gone.
using DataFile = CommitRecord::DataFile;

struct Node {
    NodeId parent = no_node;
    std::array<NodeId, 2> children{no_node, no_node};
    std::uint16_t depth = 0;        // 0 at the root
    std::uint32_t part = 0;         // no_part for a node that joins parts
    std::uint16_t first_level = 0;  // of its own points
    std::uint32_t points = 0;       // of this node's own chunk
    // How many of them, in the chunk's order, are of first_level, of the next, ...; empty for a node without points.
    std::vector<std::uint32_t> level_points;
    std::uint64_t subtree_points = 0;  // of this node and everything below
    Box3i box;                         // tight around the points of the whole subtree
    double spacing = 0;                // source units: how far apart this cloud's points lie in the subtree's box once
                                       // this node and its ancestors are drawn; 0 at a leaf (nothing is missing)
    Extent extent;
    bool is_leaf() const { return children[0] == no_node && children[1] == no_node; }
    // How many points, from the chunk's first on, belong to the cloud at `level`.
    std::uint32_t points_to_level(std::size_t level) const
    {
        std::uint32_t sum = 0;
        for (std::size_t k = 0; k < level_points.size() && first_level + k <= level; ++k) sum += level_points[k];
        return sum;
    }
};

// How the points of a level were chosen.
enum class Sampling : std::uint8_t {
    // The points of levels 0..L are a maximal Poisson-disk sample: no two are nearer than the level's spacing, and
    // every
    // point of the cloud has one of them nearer than that.
    poisson = 0,
    // One point for each cell of a lattice, whose diagonal is the spacing: quicker, and uneven. Every point has one of
    // them nearer than the spacing; how near two may be is not promised.
    grid = 1,
};

struct TreeInfo {
    std::uint32_t generation = 1;  // 1 from the build, one more with each update
    std::uint64_t points = 0;
    Grid grid;
    ScalarType position_type = ScalarType::f64;  // of the source: i32 for LAS, f32 or f64
    Schema schema;
    bool wide = false;                 // grid positions need more than 32 bits
    Box3i box;                         // tight, all points
    std::array<Vec3i, 6> extremes;     // points of the cloud with the smallest x, largest x, smallest y, ...
    double position_error = 0;         // largest distance an input coordinate was moved by, source units; 0 for LAS
    std::uint64_t points_skipped = 0;  // input points without a finite position
    std::uint64_t content_hash = 0;    // of all points with all attributes, whatever their order (point_hash.h)
    Sampling sampling = Sampling::poisson;
    bool coverage_kept =
        true;  // false after a deletion: a point's neighbour of a coarser level may be gone, up to compaction
    std::uint16_t levels = 0;
    std::vector<double> spacings;  // of each level, falling; source units; 0 for a last level that holds all the rest
    std::uint64_t bytes = 0;       // of the index and the data files, with what updates have left unused in them
    std::vector<Metadata> metadata;
    std::vector<std::string> sources;  // file names the tree was built from
    Box3d bounds() const { return grid.to_source(box); }
};

// One level of a tree in numbers.
struct LevelSummary {
    std::uint64_t nodes = 0;  // that hold points of it
    std::uint64_t points = 0;
    std::uint64_t points_to_here = 0;  // of this level and those above: of the cloud at this level
    double spacing = 0;                // 0: nothing is missing
};

inline constexpr const char* index_file_name = "index.pct";
inline constexpr const char* tree_extension = "pct";

// Consecutive points of one level of a chunk, of which the chunk keeps the box, can be read alone: segments. `chunk`
// has the points of the segments that were kept, one segment after another.
struct ChunkPart {
    Chunk chunk;
    std::vector<std::uint32_t> first;  // of each kept segment: its first point's number in the whole chunk
    std::vector<std::uint32_t> count;  // and its points
    std::uint64_t bytes_read = 0;
};

class Tree {
public:
    // `path` is the tree folder or the index file in it. A tree of more than `most_open_files` data files keeps only so
    // many of them open, besides those that are being read; they are opened when they are needed. Throws
    // Error(not_found | not_a_tree | interrupted_build | corrupt | unsupported | permission | io).
    static std::shared_ptr<const Tree> open(const std::filesystem::path& path, std::size_t most_open_files = 128);

    const std::filesystem::path& folder() const { return folder_; }
    const TreeInfo& info() const { return info_; }
    const std::vector<Node>& nodes() const { return nodes_; }
    const Node& node(NodeId id) const { return nodes_[id]; }
    Box3d box(NodeId id) const { return info_.grid.to_source(nodes_[id].box); }
    std::vector<NodeId> path_from_root(NodeId id) const;  // root first, `id` last

    // The root of each part; no_node for a part that has no points any more.
    const std::vector<NodeId>& part_roots() const { return part_roots_; }
    // What the header of the node's chunk says. For a node without a chunk the generation is the tree's.
    ChunkIdentity identity(NodeId id) const;
    const std::vector<DataFile>& data_files() const { return data_files_; }
    // The same tree with attributes added at the end of its schema, whose values are zero. On disk it stays as it is.
    std::shared_ptr<const Tree> with_schema(const Schema& longer) const;
    // Throws Error(corrupt) when a header is not that of the node's chunk.
    void check(NodeId id, const BpcHeader& header) const;

    // Nodes of levels 0..level whose boxes touch `box` (source coordinates), parents first; absent means all.
    std::vector<NodeId> nodes_in(const std::optional<Box3d>& box, std::optional<std::uint16_t> level) const;

    // Reads and decodes the asked columns of a node's chunk; verifies their checksums. A node without points gives an
    // empty chunk. Throws Error(corrupt | io | truncated), naming the data file and the byte.
    Chunk read_chunk(NodeId id, const ColumnSet& columns) const;

    // The same of some segments of the chunk: of those alone for which `wanted` holds, which is asked for each with its
    // tight box on the grid and the level of its points. What lies near together comes in one read.
    ChunkPart read_chunk_part(NodeId id, const ColumnSet& columns,
                              const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const;

    // The deepest level whose cloud has at most `points` points (0 if even the root level has more).
    std::uint16_t level_with_at_most(std::uint64_t points) const;
    std::vector<LevelSummary> level_summaries() const;
    // Number of points at level 0..level.
    std::uint64_t points_to_level(std::uint16_t level) const;

private:
    Tree() = default;
    Chunk empty_chunk(const ColumnSet& columns) const;
    std::filesystem::path folder_;
    TreeInfo info_;
    std::vector<Node> nodes_;
    std::vector<NodeId> part_roots_;
    std::vector<DataFile> data_files_;
    std::shared_ptr<DataFilePool> files_;
};

// Whether `path` looks like a tree folder or its index file (a cheap test of names and magic, not a validation).
bool is_tree(const std::filesystem::path& path);

}  // namespace pcm
